//! Bytes of a row in the temporary file of the rows.

use super::curves::{CurveFile, StoredCurve};
use super::effects::CaseEffect;
use super::outcome::{CaseDrift, RowOutcome};
use octant_score::verdict::RequirementResult;
use octant_verdict::{Comparison, Verdict};
use std::sync::Arc;

/// Names and units of the errors of attitude and velocity: rows hold their places in this list.
pub(super) type ErrorNames = Vec<(&'static str, &'static str)>;

/// Appends the bytes of a row.
pub(super) fn encode(outcome: &RowOutcome, names: &mut ErrorNames, to: &mut Vec<u8>) {
    let RowOutcome { verdict, besides, error, reasons, checks, refused, unfired, .. } = outcome;
    let RowOutcome { differs, stream_hash, drift, effect, .. } = outcome;
    // The drift comes first: most figures need it alone.
    option(drift.as_ref(), to, |drift, to| {
        let CaseDrift { duration_h, final_nmi, max_nmi, rms_nmi, rate_nmi_per_h, .. } = drift;
        for value in [duration_h, final_nmi, max_nmi, rms_nmi, rate_nmi_per_h] {
            number(*value, to);
        }
        let marks: Vec<(&String, &f64)> = drift.marks_nmi.iter().collect();
        list(&marks, to, |(name, value), to| {
            text(name, to);
            number(**value, to);
        });
        list(&drift.solution, to, |(name, unit, value), to| {
            let known = names.iter().position(|other| other == &(*name, *unit));
            let at = known.unwrap_or_else(|| {
                names.push((name, unit));
                names.len() - 1
            });
            count(at, to);
            number(*value, to);
        });
        option(drift.curve.as_ref(), to, |curve, to| {
            number(curve.step_s, to);
            count(curve.points, to);
            to.extend(curve.at().to_le_bytes());
        });
    });
    to.extend([place_of(*verdict), place_of(*besides), u8::from(*differs)]);
    option(error.as_deref(), to, text);
    list(reasons, to, |reason, to| text(reason, to));
    list(checks, to, check);
    option(refused.as_deref(), to, text);
    list(unfired, to, |fault, to| text(fault, to));
    option(stream_hash.as_deref(), to, text);
    option(effect.as_ref(), to, |effect, to| {
        let CaseEffect { shift_sigma, delay_s, undetected, refused, missed, false_alarms } = effect;
        option(*shift_sigma, to, number);
        option(*delay_s, to, number);
        to.extend(undetected.to_le_bytes());
        to.extend(false_alarms.to_le_bytes());
        to.extend([u8::from(*refused), u8::from(*missed)]);
    });
}

fn place_of(verdict: Verdict) -> u8 {
    let place = Verdict::ALL.iter().position(|other| *other == verdict);
    place.and_then(|place| u8::try_from(place).ok()).unwrap_or(u8::MAX)
}

fn check(check: &RequirementResult, to: &mut Vec<u8>) {
    let RequirementResult { id, measure, comparison, limit, value, margin, .. } = check;
    let RequirementResult { at_equator, uncertainty, verdict, reason, .. } = check;
    text(id, to);
    text(measure, to);
    text(comparison.sign(), to);
    number(*limit, to);
    for value in [at_equator, value, margin, uncertainty] {
        option(*value, to, number);
    }
    to.push(place_of(*verdict));
    option(reason.as_deref(), to, text);
}

fn number(value: f64, to: &mut Vec<u8>) {
    to.extend(value.to_le_bytes());
}

fn count(value: usize, to: &mut Vec<u8>) {
    to.extend((value as u64).to_le_bytes());
}

fn text(value: &str, to: &mut Vec<u8>) {
    count(value.len(), to);
    to.extend(value.as_bytes());
}

fn option<T>(value: Option<T>, to: &mut Vec<u8>, mut put: impl FnMut(T, &mut Vec<u8>)) {
    to.push(u8::from(value.is_some()));
    value.into_iter().for_each(|value| put(value, to));
}

fn list<T>(values: &[T], to: &mut Vec<u8>, mut put: impl FnMut(&T, &mut Vec<u8>)) {
    count(values.len(), to);
    values.iter().for_each(|value| put(value, to));
}

/// Reads a row from all of its bytes; `None` if they are none.
pub(super) fn decode(
    bytes: &[u8],
    names: &ErrorNames,
    curves: &Arc<CurveFile>,
) -> Option<RowOutcome> {
    let mut rest = Rest(bytes);
    let drift = rest.option(|rest| rest.drift(names, curves))?;
    let (verdict, besides, differs) = (rest.verdict()?, rest.verdict()?, rest.byte()? != 0);
    let outcome = RowOutcome {
        verdict,
        besides,
        differs,
        error: rest.option(Rest::text)?,
        reasons: rest.list(Rest::text)?,
        checks: rest.list(Rest::check)?,
        refused: rest.option(Rest::text)?,
        unfired: rest.list(Rest::text)?,
        stream_hash: rest.option(Rest::text)?,
        drift,
        effect: rest.option(Rest::effect)?,
    };
    rest.0.is_empty().then_some(outcome)
}

/// Reads the drift from the bytes of a row. The outer `None`: they are none.
pub(super) fn decode_drift(
    bytes: &[u8],
    names: &ErrorNames,
    curves: &Arc<CurveFile>,
) -> Option<Option<CaseDrift>> {
    Rest(bytes).option(|rest| rest.drift(names, curves))
}

/// Bytes that aren't read yet.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, after) = self.0.split_first()?;
        self.0 = after;
        Some(*first)
    }

    fn eight(&mut self) -> Option<[u8; 8]> {
        let (first, after) = self.0.split_first_chunk()?;
        self.0 = after;
        Some(*first)
    }

    fn number(&mut self) -> Option<f64> {
        self.eight().map(f64::from_le_bytes)
    }

    fn count(&mut self) -> Option<usize> {
        usize::try_from(u64::from_le_bytes(self.eight()?)).ok()
    }

    fn text(&mut self) -> Option<String> {
        let length = self.count()?;
        let (text, after) = self.0.split_at_checked(length)?;
        self.0 = after;
        Some(std::str::from_utf8(text).ok()?.to_owned())
    }

    fn verdict(&mut self) -> Option<Verdict> {
        Verdict::ALL.get(usize::from(self.byte()?)).copied()
    }

    /// The outer `None`: there are no such bytes.
    fn option<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<Option<T>> {
        if self.byte()? == 0 { Some(None) } else { read(self).map(Some) }
    }

    fn list<T>(&mut self, mut read: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        (0..self.count()?).map(|_| read(self)).collect()
    }

    fn check(&mut self) -> Option<RequirementResult> {
        Some(RequirementResult {
            id: self.text()?,
            measure: self.text()?,
            comparison: Comparison::of_sign(&self.text()?)?,
            limit: self.number()?,
            at_equator: self.option(Self::number)?,
            value: self.option(Self::number)?,
            margin: self.option(Self::number)?,
            uncertainty: self.option(Self::number)?,
            verdict: self.verdict()?,
            reason: self.option(Self::text)?,
        })
    }

    fn effect(&mut self) -> Option<CaseEffect> {
        Some(CaseEffect {
            shift_sigma: self.option(Self::number)?,
            delay_s: self.option(Self::number)?,
            undetected: u64::from_le_bytes(self.eight()?),
            false_alarms: u64::from_le_bytes(self.eight()?),
            refused: self.byte()? != 0,
            missed: self.byte()? != 0,
        })
    }

    fn drift(&mut self, names: &ErrorNames, curves: &Arc<CurveFile>) -> Option<CaseDrift> {
        Some(CaseDrift {
            duration_h: self.number()?,
            final_nmi: self.number()?,
            max_nmi: self.number()?,
            rms_nmi: self.number()?,
            rate_nmi_per_h: self.number()?,
            marks_nmi: self
                .list(|rest| Some((rest.text()?, rest.number()?)))?
                .into_iter()
                .collect(),
            solution: self
                .list(|rest| {
                    let (name, unit) = names.get(rest.count()?)?;
                    Some((*name, *unit, rest.number()?))
                })?
                .into(),
            curve: self.option(|rest| {
                let (step_s, points) = (rest.number()?, rest.count()?);
                let at = u64::from_le_bytes(rest.eight()?);
                Some(StoredCurve::new(step_s, points, at, Arc::clone(curves)))
            })?,
        })
    }
}
