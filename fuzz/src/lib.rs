//! What the fuzz targets share: the library as a C program sees it, the contract written down once more, and
//! a reader of fuzz input. The library's own Rust types are not used, so that a mistake in them can't hide itself.

pub mod abi;
pub mod contract;
pub mod gx_abi;
pub mod input;
pub mod line_abi;
pub mod line_board;
pub mod line_contract;
pub mod link;
pub mod link_abi;
pub mod link_robot;
pub mod object;
