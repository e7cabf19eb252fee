//! Pages of campaigns and sweeps, and the folder of a campaign as evidence. What they show is decided in `octant-campaign`.

pub mod campaign;
pub mod evidence;
pub mod sweep;
