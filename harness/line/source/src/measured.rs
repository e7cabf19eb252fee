//! A reference that was measured and recorded beside the samples, at stamps of its own.
//!
//! It goes to the first sample whose stamp is no further than half a sample period from its own. Nothing is
//! interpolated: a value between two measurements has the noise of both and tells the filter nothing new, and a value
//! between two samples is off by no more than the acceleration times half a sample period.

use super::reference_mcap::ReferenceMcap;
use super::reference_text::ReferenceText;
use super::{OF_REFERENCE, SourceError};
use octant_account::{Account, AccountEntry};
use octant_base::number::plain;
use octant_earth::ellipsoid::Ellipsoid;
use octant_sample::{Aiding, DeviceTime, Reference};
use octant_scenario::reference::{RecordedReference, RecordedReferenceKind};
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest distance from the site, m: beyond it a unit, a sign or the order is wrong.
const SITE_M_MAX: f64 = 10_000.0;

/// Where the reference is read from.
pub(super) enum ReferenceRows {
    Text(Box<ReferenceText>),
    Mcap(Box<ReferenceMcap>),
}

impl ReferenceRows {
    fn next(&mut self) -> Result<Option<(u64, [f64; 3])>, SourceError> {
        match self {
            Self::Text(rows) => rows.next(),
            Self::Mcap(rows) => rows.next(),
        }
    }

    fn error(&self, reason: String) -> SourceError {
        match self {
            Self::Text(rows) => rows.error(reason),
            Self::Mcap(rows) => rows.error(reason),
        }
    }

    fn error_of_file(&self, reason: String) -> SourceError {
        match self {
            Self::Text(rows) => rows.error_of_file(reason),
            Self::Mcap(rows) => rows.error_of_file(reason),
        }
    }

    /// File, name of its units, and number of those so far that have no measurement.
    fn facts(&self) -> (&str, [&'static str; 2], u64) {
        match self {
            Self::Text(rows) => (rows.path(), ["row", "rows"], rows.empty()),
            Self::Mcap(rows) => (rows.path(), ["message", "messages"], 0),
        }
    }
}

/// A reference with its stamp, ns.
#[derive(Clone, Copy, Debug)]
struct Stamped {
    time_ns: u64,
    raw: [f64; 3],
    reference: Reference,
}

/// References of a recording, which are given out sample by sample.
pub(super) struct MeasuredReference {
    rows: ReferenceRows,
    recorded: RecordedReference,
    /// Half of a sample period.
    slack_ns: u64,
    /// The last one read, and whether it waits for its sample.
    last: Option<Stamped>,
    waits: bool,
    first_ns: Option<u64>,
    /// Number of measurements that went to a sample, that repeat the one before, and that have no sample.
    given: u64,
    repeated: u64,
    apart: u64,
    /// Stamp of the first that has none.
    first_apart_ns: Option<u64>,
    has_ended: bool,
    /// Stamps of the first and the last sample.
    samples_ns: Option<(u64, u64)>,
}

impl MeasuredReference {
    pub(super) fn new(
        rows: ReferenceRows,
        recorded: &RecordedReference,
        sample_period_ns: u64,
    ) -> Self {
        Self {
            rows,
            recorded: recorded.clone(),
            slack_ns: sample_period_ns / 2,
            last: None,
            waits: false,
            first_ns: None,
            given: 0,
            repeated: 0,
            apart: 0,
            first_apart_ns: None,
            has_ended: false,
            samples_ns: None,
        }
    }

    /// Returns the reference of the sample with this stamp, if it has one.
    pub(super) fn at(&mut self, stamp: DeviceTime) -> Result<Option<Aiding>, SourceError> {
        let first_ns = self.samples_ns.map_or(stamp.ns, |(first_ns, _)| first_ns);
        self.samples_ns = Some((first_ns, stamp.ns));
        loop {
            if !self.waits && !self.read()? {
                return Ok(None);
            }
            let Some(next) = self.last else { return Ok(None) };
            if next.time_ns > stamp.ns.saturating_add(self.slack_ns) {
                return Ok(None);
            }
            self.waits = false;
            if next.time_ns.saturating_add(self.slack_ns) >= stamp.ns {
                self.given += 1;
                return Ok(Some(Aiding { device_time: stamp, reference: next.reference }));
            }
            // It is of a time before the samples, or of a gap in them.
            self.apart += 1;
            self.first_apart_ns.get_or_insert(next.time_ns);
        }
    }

    /// Checks, at the end of the samples, that there was a reference at all.
    pub(super) fn came(&self) -> Result<(), SourceError> {
        let Some((from_ns, to_ns)) = self.samples_ns.filter(|_| self.given == 0) else {
            return Ok(());
        };
        let s = |ns: u64| format!("{:.3}", ns as f64 * 1e-9);
        let found = match self.first_ns {
            None => "found no reference".to_owned(),
            Some(ns) => format!(
                "found no reference at the stamp of a sample: the first is at {} s, the last that \
                 was read at {} s",
                s(ns),
                self.last.map_or_else(String::new, |last| s(last.time_ns))
            ),
        };
        Err(self.rows.error_of_file(format!(
            "{found}; the samples are from {} s to {} s: expected stamps of the same clock, no further \
             than half a sample period, {} ms, from those of samples",
            s(from_ns),
            s(to_ns),
            self.slack_ns as f64 * 1e-6
        )))
    }

    /// Returns the account of what was read so far.
    pub(super) fn account(&self) -> Account {
        let (path, unit, empty) = self.rows.facts();
        let first_s = self.first_apart_ns.map_or(f64::NAN, |ns| ns as f64 * 1e-9);
        let apart = AccountEntry::new(
            self.apart,
            "measurements of a time before the samples, or in a gap of them",
        )
        .first(format!("at {} s", plain(first_s, 9)));
        let rest = AccountEntry::fact(
            !self.has_ended,
            "the run ended before the file: the rest is not read",
        );
        Account::new(format!("{path}{OF_REFERENCE}"), unit)
            .used(self.given)
            .left_out(AccountEntry::new(empty, "rows without a measurement"))
            .left_out(AccountEntry::new(self.repeated, "repetitions of the measurement before"))
            .left_out(apart)
            .left_out(AccountEntry::new(
                u64::from(self.waits),
                "measurement behind the last sample",
            ))
            .note(rest)
    }

    /// Reads the next reference; `false` at the end.
    fn read(&mut self) -> Result<bool, SourceError> {
        loop {
            let Some((time_ns, raw)) = self.rows.next()? else {
                self.has_ended = true;
                return Ok(false);
            };
            if let Some(last) = &self.last {
                if time_ns == last.time_ns && raw.map(f64::to_bits) == last.raw.map(f64::to_bits) {
                    // A logger repeats the last measurement until there is another one.
                    self.repeated += 1;
                    continue;
                }
                self.check_times(last.time_ns, time_ns)?;
            }
            let reference = self.reference(&raw).map_err(|reason| self.rows.error(reason))?;
            self.first_ns.get_or_insert(time_ns);
            self.last = Some(Stamped { time_ns, raw, reference });
            self.waits = true;
            return Ok(true);
        }
    }

    fn check_times(&self, last_ns: u64, time_ns: u64) -> Result<(), SourceError> {
        let Some(apart_ns) = time_ns.checked_sub(last_ns).filter(|apart_ns| *apart_ns > 0) else {
            return Err(self.rows.error(format!(
                "the reference's stamp {time_ns} ns is not after the one before, {last_ns} ns"
            )));
        };
        let period_ns = self.recorded.period_ns;
        if apart_ns < period_ns / 2 {
            return Err(self.rows.error(format!(
                "the reference is {} s after the one before, and procedure.calibration.aiding.period \
                 is {} s: expected that of the reference. Where a logger repeats a measurement in \
                 rows of its own, expected the measurement's stamps as time_column, or empty fields \
                 between measurements",
                plain(apart_ns as f64 * 1e-9, 9),
                plain(period_ns as f64 * 1e-9, 9)
            )));
        }
        Ok(())
    }

    /// Converts three numbers to SI, and checks what they can be.
    fn reference(&self, raw: &[f64; 3]) -> Result<Reference, String> {
        let RecordedReference { kind, scale, names, site_rad, .. } = &self.recorded;
        let si: [f64; 3] = std::array::from_fn(|i| raw[i] * scale[i]);
        if let Some(index) = si.iter().position(|value| !value.is_finite()) {
            let name = names[index];
            return Err(format!("{name} is {}, expected a finite number", raw[index]));
        }
        match kind {
            RecordedReferenceKind::Velocity => Ok(Reference::Velocity(si)),
            RecordedReferenceKind::Position => {
                let [latitude_rad, mut longitude_rad, height_m] = si;
                if !(-FRAC_PI_2..=FRAC_PI_2).contains(&latitude_rad) {
                    return Err(format!(
                        "latitude is {} deg, expected -90 to 90 deg",
                        plain(latitude_rad.to_degrees(), 9)
                    ));
                }
                if !(-PI..=2.0 * PI).contains(&longitude_rad) {
                    return Err(format!(
                        "longitude is {} deg, expected -180 to 360 deg",
                        plain(longitude_rad.to_degrees(), 9)
                    ));
                }
                // Both ways to count meridians; the filter takes the difference from the site's.
                if longitude_rad - site_rad[1] > PI {
                    longitude_rad -= 2.0 * PI;
                } else if longitude_rad - site_rad[1] < -PI {
                    longitude_rad += 2.0 * PI;
                }
                let earth = Ellipsoid::at(site_rad[0], 0.0);
                let north_m = (latitude_rad - site_rad[0]) * earth.meridian_radius_m;
                let east_m = (longitude_rad - site_rad[1])
                    * (earth.transverse_radius_m * earth.cos_latitude);
                let distance_m = north_m.hypot(east_m);
                if !(distance_m <= SITE_M_MAX) {
                    return Err(format!(
                        "latitude {} deg, longitude {} deg is {:.0} km from [site], expected {:.0} km \
                         at most: is it another unit, sign or order?",
                        plain(latitude_rad.to_degrees(), 9),
                        plain(longitude_rad.to_degrees(), 9),
                        distance_m * 1e-3,
                        SITE_M_MAX * 1e-3
                    ));
                }
                Ok(Reference::Position { latitude_rad, longitude_rad, height_m })
            }
        }
    }
}
