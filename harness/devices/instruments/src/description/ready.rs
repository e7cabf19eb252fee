//! Descriptions that are part of the program, of units whose formats are public.

/// Name and text of each.
pub const READY: [(&str, &str); 5] = [
    ("kvh-1775-angle", include_str!("../../descriptions/kvh-1775-angle.toml")),
    ("kvh-1775-rate", include_str!("../../descriptions/kvh-1775-rate.toml")),
    ("ln-100-like", include_str!("../../descriptions/ln-100-like.toml")),
    ("stim300-increment", include_str!("../../descriptions/stim300-increment.toml")),
    ("stim300-rate", include_str!("../../descriptions/stim300-rate.toml")),
];
