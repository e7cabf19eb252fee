//! A pass over samples that end before the calibration does.

use octant_earth::Vector3;
use octant_run::passes::pass;
use octant_sample::Mode;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario};
use octant_source::PlantSource;

#[test]
fn a_source_that_ends_early_concludes_the_calibration() {
    let text = "schema = 1\n[procedure.calibration]\nduration = \"4 h\"\n";
    let scenario = Scenario::parse(text, "f", std::path::Path::new(""), &[]).unwrap();
    let draws = DrawnValues::of(&scenario, &Seeded(1));
    let (q_nb, velocity) = (scenario.mean_attitude(), Vector3::zeros());
    let config = scenario.core(Method::Primary, &draws, &q_nb, &velocity).unwrap();
    // Twelfth part of the calibration's time.
    let samples = scenario.calibration_samples() / 12;
    let source = PlantSource::new(&scenario.plant(1, &draws), samples).unwrap();
    let mut core = pass(&config, source).unwrap();
    assert_eq!(core.refusal(), None);
    let table = core.table().cloned().unwrap();
    assert_eq!(table.provenance.ended_ns, samples * scenario.sample_period_ns);
    assert!(table.quality.used > 1000, "{:?}", table.quality);
    let before = core.end_of_stream();
    assert_eq!((before.mode, core.table()), (Mode::Done, Some(&table)), "harmless again");
}
