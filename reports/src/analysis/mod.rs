//! From runs to numbers: groups of runs, their curves and scores, comparisons, and verdicts on a paper's
//! claims.

pub mod ablation;
pub mod aggregate;
pub mod catalogue;
pub mod comparison;
pub mod complete;
pub mod cost;
pub mod curves;
pub mod efficiency;
pub mod finals;
pub mod frontier;
pub mod goal_map;
pub mod group;
pub mod groups;
pub mod guests;
pub mod heat;
pub mod improvement;
pub mod ledger;
pub mod levels;
pub mod missing;
pub mod numbers;
pub mod options;
pub mod pairing;
pub mod readings;
pub mod scores;
pub mod shadow;
pub mod student;
pub mod subset;
pub mod summary;
pub mod teaching;
pub mod tuning;
pub mod variants;
pub mod weighted;
pub mod whole;
