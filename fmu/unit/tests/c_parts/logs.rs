//! Messages to the importer.

use super::log::{CATEGORIES, Log, text};
use octant_fmi::fmi2::{DISCARD, ERROR, FATAL, OK, WARNING};
use octant_fmu::c::ServedStandard;

#[test]
fn categories_are_switched_by_name() {
    let mut log = Log::new(ServedStandard::Fmi3, false, true);
    assert!(CATEGORIES.iter().all(|_| !log.wants(ERROR)));
    let names = ["logStatusError".to_owned(), "logNonsense".to_owned()];
    assert_eq!(log.switch(true, Some(&names)), ["logNonsense"]);
    assert!(log.wants(ERROR) && !log.wants(FATAL) && !log.wants(OK));
    log.switch(true, Some(&["logAll".to_owned()]));
    assert!(log.wants(OK) && log.wants(DISCARD) && log.wants(FATAL));
    log.switch(false, Some(&["logEvents".to_owned()]));
    assert!(!log.wants(OK) && log.wants(DISCARD));
    log.switch(false, None);
    assert!(!log.wants(ERROR));
    log.switch(true, None);
    assert!(log.wants(WARNING));
}

#[test]
fn fmi_2_tells_errors_in_any_case_and_nobody_hears_without_a_callback() {
    let log = Log::new(ServedStandard::Fmi2, false, true);
    assert!(log.wants(ERROR) && log.wants(WARNING) && log.wants(FATAL));
    assert!(!log.wants(OK) && !log.wants(DISCARD));
    let mut deaf = Log::new(ServedStandard::Fmi2, true, false);
    deaf.say(ERROR, "unheard".to_owned());
    assert!(deaf.is_silent());
}

#[test]
fn texts_have_no_references_to_variables_by_accident() {
    assert_eq!(text("channel #4 of 100 %\n").as_c_str(), c"channel ##4 of 100 %");
    assert_eq!(text("a\0b").as_c_str(), c"a b");
}
