//! A summary, and how it is judged.

use octant_score::judge::{Finding, judge};
use octant_score::summary::{
    CalibrationScore, ErrorScore, FaultResult, HealthCounts, HeightChannel, NavigationScore,
    RadialScore, SCHEMA, Summary,
};
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{Comparison, Verdict};
use std::collections::BTreeMap;

pub(crate) fn summary() -> Summary {
    let score = ErrorScore {
        max: 0.75,
        rms: 0.4,
        r#final: -0.6,
        slope_per_day: None,
        schuler_amplitude: None,
    };
    Summary {
        schema: SCHEMA,
        octant: "0.1.0".to_owned(),
        numerics: None,
        scenario: "dock <&> quay".to_owned(),
        seed: 7,
        verdict: Verdict::Pass,
        reasons: vec![],
        requirements: vec![],
        findings: Vec::new(),
        decision: None,
        planned: None,
        done: None,
        faults: vec![],
        followed: None,
        false_alarms: None,
        heading: None,
        method: "eight".to_owned(),
        calibration: Some(CalibrationScore {
            reference: None,
            solution: None,
            positions: "eight".to_owned(),
            estimator: "kalman".to_owned(),
            duration_h: 4.0,
            parameters: BTreeMap::new(),
            further: BTreeMap::new(),
            nis_mean: Some(3.01),
            nis_expected: None,
            rest: None,
            nees: BTreeMap::new(),
            worst_normalized_error: None,
            least_gain: None,
            refused: None,
            refusal_explained: Vec::new(),
            health: HealthCounts::default(),
            sigma_hours: Vec::new(),
        }),
        navigation: Some(NavigationScore {
            duration_h: 1.0,
            height: HeightChannel::Held,
            latitude_error_arcmin: Some(score),
            longitude_error_arcmin: Some(score),
            radial_error_nmi: Some(RadialScore {
                max: 1.0,
                rms: 0.5,
                r#final: 0.9,
                rate_per_h: 0.8,
            }),
            heading_output: None,
            heading_error_arcmin: None,
            pitch_error_arcmin: None,
            roll_error_arcmin: None,
            velocity_north_error_mps: None,
            velocity_east_error_mps: None,
            slope_window: None,
            marks: BTreeMap::new(),
            gaps: None,
            series_hours: vec![[0.0, 0.0, 0.0], [1.0, 0.1, -0.6]],
        }),
        baseline: None,
        reference: None,
        inputs: Vec::new(),
        altered_streams: None,
        alignment: None,
        counterfactual: None,
        allan_deviation: None,
        pacing: None,
        stream_hash: "00".to_owned(),
    }
}

pub(crate) fn requirement(measure: &str, comparison: Comparison, limit: f64) -> LimitCheck {
    LimitCheck {
        id: "NAV-1".to_owned(),
        measure: measure.to_owned(),
        comparison,
        limit,
        secant_latitude: false,
    }
}

pub(crate) fn judged(requirements: &[LimitCheck], findings: &[Finding]) -> Summary {
    let mut summary = summary();
    judge(&mut summary, requirements, findings).unwrap();
    summary
}

/// Makes the result of a fault that never fired.
pub(crate) fn silent() -> FaultResult {
    FaultResult {
        id: "spike".to_owned(),
        kind: "spike".to_owned(),
        armed: true,
        fired: false,
        first_sample: None,
        last_sample: None,
        samples_altered: 0,
        firings: 0,
        clean_crc32: None,
        faulted_crc32: None,
        largest_change: None,
    }
}
