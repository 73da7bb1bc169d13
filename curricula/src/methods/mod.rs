//! The methods, one file each: from the paper's idea to the code, with deviations and choices listed on top.
//!
//! A method is declared here and becomes part of the program by its row in [`crate::CURRICULA`].

pub mod her_iid;
pub mod her_iid_pool;
pub mod procurl;
pub mod space;
pub mod teach;
pub mod vds;
