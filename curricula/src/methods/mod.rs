//! The methods, one file each: from the paper's idea to the code, with deviations and choices listed on top.
//!
//! A method is its file, its `pub mod` line here, and its row in [`crate::CURRICULA`], which makes it part of
//! the program.

pub mod alp_gmm;
pub mod goid;
pub mod her_iid;
pub mod her_iid_pool;
pub mod hgg;
pub mod lp;
pub mod mega;
pub mod omega;
pub mod plr;
pub mod process;
pub mod procurl;
pub mod sfl;
pub mod space;
pub mod teach;
pub mod vds;
