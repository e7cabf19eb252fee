//! Buffers for numbers of the types of FMI 3.0.

use super::number::Truth;

/// Buffers for numbers of each type.
#[derive(Default)]
pub(super) struct Scratch {
    pub(super) float32: Vec<f32>,
    pub(super) int8: Vec<i8>,
    pub(super) uint8: Vec<u8>,
    pub(super) int16: Vec<i16>,
    pub(super) uint16: Vec<u16>,
    pub(super) int32: Vec<i32>,
    pub(super) uint32: Vec<u32>,
    pub(super) int64: Vec<i64>,
    pub(super) uint64: Vec<u64>,
    pub(super) truths: Vec<Truth<u8>>,
}
