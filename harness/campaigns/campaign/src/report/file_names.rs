//! Names of the files of a report in the folder of a campaign.

/// Name of the page in the folder of a campaign.
pub const PAGE: &str = "report.html";
/// Name of the statistics file.
pub const STATISTICS: &str = "statistics.json";
/// Name of the file that compares predicted ensembles with the cases.
pub const PREDICTION: &str = "prediction.json";
/// Name of the JUnit file.
pub const JUNIT: &str = "junit.xml";
