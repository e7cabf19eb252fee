//! A finished calibration: parameters, their full covariance, quality and provenance, as bytes for
//! storing and loading.
//!
//! Layout, little-endian: magic `OCTCAL`, version u16, then the fields of [`CalibrationTable`] in
//! order (the covariance as its upper triangle by rows; the first four fields of the quality, the
//! others follow the provenance since version 2), then CRC-32 (ISO-HDLC) of all before.

use octant_sample::Parameters;
use octant_sample::parameters::PARAMETER_COUNT;

/// Version of the layout that this core writes, and the newest version that it reads.
pub const TABLE_VERSION: u16 = 2;

const MAGIC: &[u8; 6] = b"OCTCAL";
const TRIANGLE: usize = PARAMETER_COUNT * (PARAMETER_COUNT + 1) / 2;
/// Length of a table of version 1, which ends with the provenance.
const FIRST_TABLE_BYTES: usize = 6 + 2 + 8 * (PARAMETER_COUNT + TRIANGLE) + 8 * 4 + 8 * 6 + 2 + 4;
/// Length of a table in bytes.
pub const TABLE_BYTES: usize = FIRST_TABLE_BYTES + 8 * 3;

const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// A finished calibration.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct CalibrationTable {
    /// Estimated parameters, SI.
    pub parameters: Parameters,
    /// Covariance of the parameters in the order of [`octant_sample::parameters::NAMES`], SI.
    /// A parameter that was not estimated has variance NaN.
    pub covariance: [[f64; PARAMETER_COUNT]; PARAMETER_COUNT],
    /// Quality of the calibration.
    pub quality: Quality,
    /// Origin of the calibration.
    pub provenance: Provenance,
}

/// Quality of a calibration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Quality {
    /// Mean normalized innovation squared (three axes); NaN if the method has none.
    pub nis_mean: f64,
    /// Measurements or intervals used.
    pub used: u64,
    /// Measurements rejected.
    pub rejected: u64,
    /// Recoveries of the filter.
    pub recoveries: u64,
    /// Samples that were missing or not used, and bridged by the known motion.
    pub bridged: u64,
    /// Number of times that gyros and encoders disagreed on a turn.
    pub gimbal_slips: u64,
    /// Largest correction of a parameter over a stretch of the calibration, in the standard
    /// deviations that it should have; 0 without the test.
    pub drift_sigmas: f64,
}

/// Origin of a calibration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Provenance {
    /// Device time at its end, ns.
    pub ended_ns: u64,
    /// Length, s.
    pub duration_s: f64,
    /// Stops visited, over all passes.
    pub stops: u64,
    /// Latitude of the site, rad.
    pub latitude_rad: f64,
    /// Longitude of the site, rad.
    pub longitude_rad: f64,
    /// Height of the site, m.
    pub height_m: f64,
    /// Method: 0 Kalman filter, 1 least squares, 2 external turntable.
    pub method: u16,
}

/// Reason why bytes are not a calibration table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CalibrationTableError {
    /// Wrong length.
    #[error("calibration table has {found} bytes, {expected} are expected")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes of a table of its version.
        expected: usize,
    },
    /// Wrong magic.
    #[error("not a calibration table: it does not begin with OCTCAL")]
    Magic,
    /// A newer version.
    #[error("calibration table has version {found}, this core reads up to {TABLE_VERSION}")]
    Version {
        /// Version found.
        found: u16,
    },
    /// Wrong checksum.
    #[error("calibration table is damaged: checksum {found:#010x}, computed {computed:#010x}")]
    Checksum {
        /// Checksum in the bytes.
        found: u32,
        /// Checksum of the bytes.
        computed: u32,
    },
}

struct Cursor<'a> {
    bytes: &'a mut [u8],
    at: usize,
}

impl Cursor<'_> {
    fn put(&mut self, bytes: &[u8]) {
        self.bytes[self.at..self.at + bytes.len()].copy_from_slice(bytes);
        self.at += bytes.len();
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        taken.copy_from_slice(&self.bytes[self.at..self.at + N]);
        self.at += N;
        taken
    }

    fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }
}

impl CalibrationTable {
    /// Converts the table to bytes.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; TABLE_BYTES] {
        let mut bytes = [0; TABLE_BYTES];
        let mut w = Cursor { bytes: &mut bytes, at: 0 };
        w.put(MAGIC);
        w.put(&TABLE_VERSION.to_le_bytes());
        for value in self.parameters.to_array() {
            w.put(&value.to_le_bytes());
        }
        for (i, row) in self.covariance.iter().enumerate() {
            for value in &row[i..] {
                w.put(&value.to_le_bytes());
            }
        }
        w.put(&self.quality.nis_mean.to_le_bytes());
        for count in [self.quality.used, self.quality.rejected, self.quality.recoveries] {
            w.put(&count.to_le_bytes());
        }
        let p = &self.provenance;
        w.put(&p.ended_ns.to_le_bytes());
        w.put(&p.duration_s.to_le_bytes());
        w.put(&p.stops.to_le_bytes());
        for value in [p.latitude_rad, p.longitude_rad, p.height_m] {
            w.put(&value.to_le_bytes());
        }
        w.put(&p.method.to_le_bytes());
        w.put(&self.quality.bridged.to_le_bytes());
        w.put(&self.quality.gimbal_slips.to_le_bytes());
        w.put(&self.quality.drift_sigmas.to_le_bytes());
        let at = w.at;
        let checksum = CRC.checksum(&bytes[..at]);
        bytes[at..].copy_from_slice(&checksum.to_le_bytes());
        bytes
    }

    /// Reads a table from its bytes.
    ///
    /// # Errors
    /// If the bytes are not a table, are damaged, or are of a newer version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CalibrationTableError> {
        if bytes.len() < 8 || bytes[..6] != *MAGIC {
            return Err(CalibrationTableError::Magic);
        }
        let version = u16::from_le_bytes([bytes[6], bytes[7]]);
        if version > TABLE_VERSION {
            return Err(CalibrationTableError::Version { found: version });
        }
        let expected = if version < 2 { FIRST_TABLE_BYTES } else { TABLE_BYTES };
        if bytes.len() != expected {
            return Err(CalibrationTableError::Length { found: bytes.len(), expected });
        }
        let (body, tail) = bytes.split_at(expected - 4);
        let found = u32::from_le_bytes([tail[0], tail[1], tail[2], tail[3]]);
        let computed = CRC.checksum(body);
        if found != computed {
            return Err(CalibrationTableError::Checksum { found, computed });
        }
        let mut r = Reader { bytes: body, at: 8 };
        let mut all = [0.0; PARAMETER_COUNT];
        for value in &mut all {
            *value = r.f64();
        }
        let mut covariance = [[0.0; PARAMETER_COUNT]; PARAMETER_COUNT];
        for i in 0..PARAMETER_COUNT {
            for j in i..PARAMETER_COUNT {
                covariance[i][j] = r.f64();
                covariance[j][i] = covariance[i][j];
            }
        }
        let mut quality = Quality {
            nis_mean: r.f64(),
            used: r.u64(),
            rejected: r.u64(),
            recoveries: r.u64(),
            ..Quality::default()
        };
        let provenance = Provenance {
            ended_ns: r.u64(),
            duration_s: r.f64(),
            stops: r.u64(),
            latitude_rad: r.f64(),
            longitude_rad: r.f64(),
            height_m: r.f64(),
            method: u16::from_le_bytes(r.take()),
        };
        if version >= 2 {
            quality.bridged = r.u64();
            quality.gimbal_slips = r.u64();
            quality.drift_sigmas = r.f64();
        }
        let parameters = Parameters::from_array(&all);
        Ok(Self { parameters, covariance, quality, provenance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> CalibrationTable {
        let all = core::array::from_fn(|i| i as f64 * 0.1);
        CalibrationTable {
            parameters: Parameters::from_array(&all),
            covariance: core::array::from_fn(|i| {
                core::array::from_fn(|j| (i.min(j) * 100 + i.max(j)) as f64)
            }),
            quality: Quality {
                nis_mean: 3.0,
                used: 7,
                rejected: 8,
                recoveries: 9,
                bridged: 10,
                gimbal_slips: 11,
                drift_sigmas: 2.5,
            },
            provenance: Provenance {
                ended_ns: 1,
                duration_s: 2.0,
                stops: 19,
                latitude_rad: 0.5,
                longitude_rad: 2.0,
                height_m: 10.0,
                method: 2,
            },
        }
    }

    #[test]
    fn a_table_survives_its_bytes() {
        let table = example();
        assert_eq!(CalibrationTable::from_bytes(&table.to_bytes()), Ok(table));
    }

    #[test]
    fn a_table_of_version_1_is_read() {
        let mut bytes = example().to_bytes();
        bytes[6] = 1;
        let end = FIRST_TABLE_BYTES - 4;
        let checksum = CRC.checksum(&bytes[..end]);
        bytes[end..][..4].copy_from_slice(&checksum.to_le_bytes());
        let table = CalibrationTable::from_bytes(&bytes[..FIRST_TABLE_BYTES]).unwrap();
        let quality =
            Quality { bridged: 0, gimbal_slips: 0, drift_sigmas: 0.0, ..example().quality };
        assert_eq!(table, CalibrationTable { quality, ..example() });
        assert!(CalibrationTable::from_bytes(&bytes).is_err(), "longer than its version");
    }

    #[test]
    fn any_flipped_bit_is_found() {
        let bytes = example().to_bytes();
        for at in 0..bytes.len() {
            let mut damaged = bytes;
            damaged[at] ^= 1 << (at % 8);
            assert!(CalibrationTable::from_bytes(&damaged).is_err(), "byte {at}");
        }
        for length in 0..bytes.len() {
            assert!(CalibrationTable::from_bytes(&bytes[..length]).is_err(), "length {length}");
        }
    }

    #[test]
    fn a_newer_version_is_refused_in_plain_words() {
        let mut bytes = example().to_bytes();
        bytes[6] = 9;
        assert_eq!(
            CalibrationTable::from_bytes(&bytes),
            Err(CalibrationTableError::Version { found: 9 })
        );
    }
}
