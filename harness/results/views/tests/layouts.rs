//! Every path of a layout names a field of a topic, and every topic is shown.

use octant_recorder::further::FurtherChannel;
use octant_sample::parameters::NAMES;
use octant_views::published::PublishedChannel;
use octant_views::standard::StandardTopic;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;

fn fixture(name: &str) -> String {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures")).join(name);
    std::fs::read_to_string(path).unwrap()
}

/// Channels of recordings and live runs.
fn channels() -> Vec<FurtherChannel> {
    let standard = StandardTopic::BRIEF.map(StandardTopic::channel);
    standard.into_iter().chain(PublishedChannel::ALL.map(PublishedChannel::channel)).collect()
}

/// Fields of each type in a definition of ROS 2, by the type's name; the message's own is "".
fn types(definition: &str) -> BTreeMap<String, BTreeMap<String, String>> {
    let mut types: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    let mut of = String::new();
    for line in definition.lines() {
        if let Some(name) = line.strip_prefix("MSG: ") {
            of = name.to_owned();
        } else if !line.contains('=')
            && let [kind, name, ..] = line.split(' ').collect::<Vec<_>>()[..]
        {
            types.entry(of.clone()).or_default().insert(name.to_owned(), kind.to_owned());
        }
    }
    types
}

/// Whether a channel has a number, text or list under these fields.
fn has_field(channel: &FurtherChannel, fields: &[&str]) -> bool {
    if channel.schema_encoding == "jsonschema" {
        let schema: Value = serde_json::from_str(&channel.schema).unwrap();
        let found = fields.iter().try_fold(&schema, |at, field| at["properties"].get(field));
        return found.is_some_and(|found| found["properties"].is_null());
    }
    let types = types(&channel.schema);
    let found = fields.iter().try_fold("", |of, field| types.get(of)?.get(*field).map(|k| &**k));
    found.is_some_and(|kind| !types.contains_key(kind))
}

fn strings<'a>(value: &'a Value, found: &mut Vec<&'a str>) {
    match value {
        Value::String(text) => found.push(text),
        Value::Array(values) => values.iter().for_each(|value| strings(value, found)),
        Value::Object(values) => values.values().for_each(|value| strings(value, found)),
        _ => {}
    }
}

#[test]
fn foxglove_shows_every_topic_and_every_parameter() {
    let layout: Value = serde_json::from_str(&fixture("foxglove/octant-layout.json")).unwrap();
    let mut texts = Vec::new();
    strings(&layout["configById"], &mut texts);
    let paths: Vec<&str> = texts.into_iter().filter(|text| text.starts_with('/')).collect();
    let channels = channels();
    for path in &paths {
        let mut parts = path.split('.');
        let topic = parts.next().unwrap();
        let channel = channels.iter().find(|channel| channel.topic == topic);
        let channel = channel.unwrap_or_else(|| panic!("nobody publishes {topic}"));
        let fields: Vec<&str> = parts.collect();
        assert!(fields.is_empty() || has_field(channel, &fields), "{path}: no such field");
    }
    for channel in &channels {
        let is_shown = |path: &&&str| path.split('.').next() == Some(channel.topic);
        assert!(paths.iter().find(is_shown).is_some(), "{} is not shown", channel.topic);
    }
    for name in NAMES {
        for part in ["value", "sigma"] {
            let path = format!("/octant/parameters.{name}.{part}");
            assert!(paths.contains(&path.as_str()), "{path} is not shown");
        }
    }
}

#[test]
fn foxglove_finds_a_place_for_every_panel() {
    let layout: Value = serde_json::from_str(&fixture("foxglove/octant-layout.json")).unwrap();
    let panels = layout["configById"].as_object().unwrap();
    let mut placed = Vec::new();
    strings(&layout["layout"], &mut placed);
    for (name, panel) in panels {
        if name.starts_with("Tab!") {
            strings(&panel["tabs"], &mut placed);
        }
    }
    for panel in panels.keys() {
        let times = placed.iter().filter(|name| *name == panel).count();
        assert_eq!(times, 1, "{panel} has {times} places");
    }
    for id in placed.iter().filter(|text| text.contains('!')) {
        assert!(panels.contains_key(*id), "there is no panel {id}");
    }
}

#[test]
fn plotjuggler_plots_fields_that_are_there() {
    let layout = fixture("plotjuggler/octant-layout.xml");
    let channels = channels();
    let mut curves = 0;
    for rest in layout.split("<curve name=\"").skip(1) {
        let path = rest.split('"').next().unwrap();
        let fields = channels.iter().find_map(|channel| {
            let fields = path.strip_prefix(channel.topic)?.strip_prefix('/')?;
            Some((channel, fields.split('/').collect::<Vec<_>>()))
        });
        let (channel, fields) = fields.unwrap_or_else(|| panic!("{path}: nobody publishes it"));
        assert!(has_field(channel, &fields), "{path}: no such field");
        curves += 1;
    }
    assert!(curves > 40, "{curves} curves");
}

#[test]
fn fields_that_are_not_there_are_found() {
    let channels = channels();
    let of = |topic: &str| channels.iter().find(|channel| channel.topic == topic).unwrap();
    assert!(has_field(of("/imu/data"), &["angular_velocity", "x"]));
    assert!(has_field(of("/imu/data"), &["header", "stamp", "nanosec"]));
    assert!(has_field(of("/octant/parameters"), &["g_zz", "sigma"]));
    for (topic, fields) in [
        ("/imu/data", &["angular_velocity"][..]),
        ("/imu/data", &["angular_velocity", "w"]),
        ("/fix", &["vector", "x"]),
        ("/octant/parameters", &["g_zz"]),
        ("/octant/error", &["height_m"]),
    ] {
        assert!(!has_field(of(topic), fields), "{topic} {fields:?}");
    }
}
