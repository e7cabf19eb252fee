//! Messages of a run as messages of ROS 2: their fields, and bytes that rosbags 0.11.9 writes for them.

use octant_views::published::PublishedChannel;
use octant_views::ros_published::{ros_channel, write};
use serde_json::{Value, json};

const FAULTS: &str = "\
    000100000c000000404890140100000000000000020000000000000001000000000000000000000000000000020000000200\
    000061000000060000007370696b65000000070000006174203320730001000000000700000000000000070000007365636f\
    6e64000006000000737475636b00000001000000000000000000000000000000";
const STATE: &str = "\
    000100000c000000404890140100000000000000713d0ad7a3b02840000000000000f87f0c00000063616c6962726174696e\
    6700010000000000000003000000000000000000000000000000010000000200000002000000610000000c0000006c617465\
    2073616d706c65000500000000000000";

fn bytes(channel: PublishedChannel, message: &Value) -> String {
    let mut bytes = Vec::new();
    write(channel, 12_345_000_000, message, &mut bytes);
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn every_field_of_a_message_in_json_is_one_in_cdr() {
    for channel in PublishedChannel::ALL {
        let schema = channel.schema();
        let mut json: Vec<&str> =
            schema["properties"].as_object().unwrap().keys().map(String::as_str).collect();
        let text = ros_channel(channel).schema;
        let own = text.split("====").next().unwrap();
        let mut cdr: Vec<&str> =
            own.lines().skip(1).map(|line| line.rsplit(' ').next().unwrap()).collect();
        json.sort_unstable();
        cdr.sort_unstable();
        assert_eq!(json, cdr, "{channel:?}");
        assert_eq!(ros_channel(channel).topic, channel.channel().topic);
    }
}

#[test]
fn texts_lists_and_parts_are_laid_out_as_rosbags_does() {
    let faults = json!({ "armed": 2, "fired": 1, "acting": 0, "faults": [
        { "id": "a", "kind": "spike", "when": "at 3 s", "acts": true, "firings": 7 },
        { "id": "second", "kind": "stuck", "when": "", "acts": false, "firings": 0 },
    ] });
    assert_eq!(bytes(PublishedChannel::Faults, &faults), FAULTS);
    // What is unknown is no number; a position that there isn't is 0.
    let state = json!({
        "time_s": 12.345, "done_percent": null, "mode": "calibrating", "mode_number": 1, "stop": 3,
        "position": null, "moving": true, "health": ["a", "late sample"], "health_bits": 5,
    });
    assert_eq!(bytes(PublishedChannel::State, &state), STATE);
}
