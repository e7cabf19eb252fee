//! `octant observe --protection`: the largest shifts that the drift test leaves unnoticed.

use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::terminal::{print, print_json};
use octant_base::number::significant;
use octant_calibration::covariance::PARAMETERS;
use octant_observe::covariance::state_name;
use octant_observe::ensemble::state_unit;
use octant_observe::protection::{Protection, protection};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_scenario::Method;
use octant_verdict::Verdict;
use serde::Serialize;

/// Probabilities that the test misses a jump, and the quantiles of a normal variable.
const MISSED: [(f64, f64); 2] = [(0.5, 0.0), (0.001, 3.090_232_306_167_813)];

#[derive(Serialize)]
struct Unnoticed {
    method: String,
    /// Limit of the drift test, σ.
    limit_sigmas: f64,
    parameters: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    name: String,
    unit: &'static str,
    sigma: f64,
    /// Worst jump; null where no jump that is tested moves the parameter.
    jump: Option<JumpRow>,
}

#[derive(Serialize)]
struct JumpRow {
    /// The parameter that jumps, and the unit of the sizes.
    parameter: String,
    unit: &'static str,
    from_s: f64,
    to_s: f64,
    sizes: Vec<Size>,
}

/// A size of a jump, and what it does.
#[derive(Serialize)]
struct Size {
    missed_probability: f64,
    jump: f64,
    shift: f64,
    shift_sigmas: f64,
}

pub(super) fn command(arguments: &ScenarioArguments, json: bool) -> Result<Verdict, Failure> {
    let scenario = load(arguments, &[])?;
    let found = protection(&scenario, Method::Primary)
        .map_err(|error| Failure::input(format!("failed to {error}")))?;
    let found = unnoticed(scenario.method_label(Method::Primary), &found);
    if json {
        print_json(&found)?
    } else {
        print(&text(&found))?
    }
    Ok(Verdict::Pass)
}

fn unnoticed(method: String, found: &Protection) -> Unnoticed {
    let row = |i: usize| {
        let (unit, si) = state_unit(PARAMETERS + i);
        let sigma = found.sigma[i];
        let jump = found.worst[i].map(|jump| {
            let (jump_unit, jump_si) = state_unit(PARAMETERS + jump.parameter);
            let sizes = MISSED.iter().map(|(missed_probability, quantile)| {
                let z = found.limit_sigmas + quantile;
                Size {
                    missed_probability: *missed_probability,
                    jump: jump.size * z / jump_si,
                    shift: jump.shift * z / si,
                    shift_sigmas: jump.shift * z / sigma,
                }
            });
            JumpRow {
                parameter: state_name(PARAMETERS + jump.parameter),
                unit: jump_unit,
                from_s: jump.between_s.0,
                to_s: jump.between_s.1,
                sizes: sizes.collect(),
            }
        });
        Row { name: state_name(PARAMETERS + i), unit, sigma: sigma / si, jump }
    };
    let parameters = (0..PARAMETER_COUNT).map(row).collect();
    Unnoticed { method, limit_sigmas: found.limit_sigmas, parameters }
}

fn text(found: &Unnoticed) -> String {
    use std::fmt::Write as _;
    let mut out = format!("{}\n", found.method);
    let _ = writeln!(
        out,
        "  largest shift by a jump of one parameter, which the drift test ({} σ) misses in half of all\n  cases and in \
         one of a thousand",
        significant(found.limit_sigmas, 3)
    );
    let _ = writeln!(
        out,
        "  {:24} {:>10} {:>10} {:>7} {:>10} {:>7}  {:9} jump",
        "published", "σ", "1 of 2", "σ", "1 of 1000", "σ", "unit"
    );
    for row in &found.parameters {
        let _ = write!(out, "  {:24} {:>10}", row.name, significant(row.sigma, 4));
        let Some(jump) = &row.jump else {
            let _ = writeln!(out, " {:>10}", "-");
            continue;
        };
        for size in &jump.sizes {
            let _ = write!(out, " {:>10} {:>7.1}", significant(size.shift, 4), size.shift_sigmas);
        }
        let _ = writeln!(
            out,
            "  {:9} {} by {} {}, {:.0} to {:.0} s",
            row.unit,
            jump.parameter,
            significant(jump.sizes[0].jump, 3),
            jump.unit,
            jump.from_s,
            jump.to_s
        );
    }
    out
}
