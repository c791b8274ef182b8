//! What the fuzz targets share: the contract written down once more, both ends of a link, memory as C programs have it,
//! and a reader of fuzz input. They call the functions of the C ABI.

pub mod contract;
pub mod input;
pub mod line_board;
pub mod line_contract;
pub mod link;
pub mod link_robot;
pub mod message;
pub mod object;
