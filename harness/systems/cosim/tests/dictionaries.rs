//! Signal dictionaries: entries are written and read by way of references anywhere in the system.

use super::ssp::{IN, OUT, component, read};
use octant_cosim::convert::{Terminal, WireConversion, WireUnit};
use octant_cosim::flat::Flat;
use octant_cosim::references;
use octant_fmu_host::description::VariableType;

const BUS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<ssb:SignalDictionary version="1.0"
    xmlns:ssb="http://ssp-standard.org/SSP1/SystemStructureSignalDictionary"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
  <ssb:DictionaryEntry name="heading"><ssc:Real unit="quarter"/></ssb:DictionaryEntry>
  <ssb:DictionaryEntry name="count"><ssc:Int16/></ssb:DictionaryEntry>
  <ssb:DictionaryEntry name="mode"><ssc:Enumeration name="Mode"/></ssb:DictionaryEntry>
  <ssb:DictionaryEntry name="short"><ssc:Float32/></ssb:DictionaryEntry>
  <ssb:DictionaryEntry name="text"><ssc:String/></ssb:DictionaryEntry>
  <ssb:DictionaryEntry name="three"><ssc:Float64/><ssc:Dimension size="3"/></ssb:DictionaryEntry>
  <ssb:Enumerations><ssc:Enumeration name="Mode"><ssc:Item name="off" value="0"/>
    <ssc:Item name="on" value="4"/></ssc:Enumeration></ssb:Enumerations>
  <ssb:Units><ssc:Unit name="quarter"><ssc:BaseUnit rad="1" factor="1.5707963267948966"/>
    </ssc:Unit></ssb:Units>
</ssb:SignalDictionary>"#;

const DICTIONARIES: &str = r#"<SignalDictionaries>
  <SignalDictionary name="bus" source="bus.ssb"/></SignalDictionaries>"#;

fn reference(name: &str, connectors: &str) -> String {
    format!(
        r#"<SignalDictionaryReference name="{name}" dictionary="bus">
             <Connectors>{connectors}</Connectors></SignalDictionaryReference>"#
    )
}

fn inout(name: &str) -> String {
    format!(r#"<Connector name="{name}" kind="inout"/>"#)
}

fn connect(from: &str, to: &str, more: &str) -> String {
    let ((a, y), (b, u)) = (from.split_once('.').unwrap(), to.split_once('.').unwrap());
    format!(
        r#"<Connection startElement="{a}" startConnector="{y}" endElement="{b}"
                       endConnector="{u}" {more}/>"#
    )
}

/// A system in which a writes an entry, and b reads it two levels deeper.
fn hierarchy(entry: &str, write: &str, read: &str) -> String {
    let (a, b) =
        (component("a", &format!("{IN}{OUT}"), ""), component("b", &format!("{IN}{OUT}"), ""));
    let (outer, inner) = (reference("here", &inout(entry)), reference("there", &inout(entry)));
    format!(
        r#"<System name="top"><Elements>{a}{outer}
             <System name="mid"><Elements><System name="low"><Elements>{b}{inner}</Elements>
               <Connections>{read}</Connections></System></Elements></System></Elements>
           <Connections>{write}</Connections>{DICTIONARIES}</System>
           <Units><ssc:Unit name="rad"><ssc:BaseUnit rad="1"/></ssc:Unit>
             <ssc:Unit name="deg"><ssc:BaseUnit rad="1" factor="0.017453292519943295"/></ssc:Unit>
           </Units>"#
    )
}

fn plain(entry: &str) -> String {
    hierarchy(
        entry,
        &connect("a.y", &format!("here.{entry}"), ""),
        &connect(&format!("there.{entry}"), "b.u", ""),
    )
}

fn end(kind: VariableType, unit: Option<&str>) -> Terminal<'static> {
    let unit = unit.map(|name| WireUnit::named(name, &[]));
    Terminal { kind, unit, items: &[], enumeration: None }
}

fn through(flat: &Flat, from: &Terminal<'_>, to: &Terminal<'_>) -> Result<WireConversion, String> {
    WireConversion::of(from, to, &flat.wires[0].hops, &[]).map_err(|error| error.to_string())
}

fn wires(flat: &Flat) -> Vec<String> {
    let name = |port: &octant_cosim::flat::FmuConnector| {
        format!("{}.{}", flat.components[port.component].name, port.connector)
    };
    flat.wires.iter().map(|w| format!("{} -> {}", name(&w.from), name(&w.to))).collect()
}

#[test]
fn an_entry_carries_values_from_one_level_to_another() {
    let (_, flat) = read(&plain("heading"), &[("bus.ssb", BUS)]).unwrap();
    assert_eq!(wires(&flat), ["a.y -> mid.low.b.u"]);
    assert!(flat.warnings.is_empty(), "{:?}", flat.warnings);
    // π rad are two quarters of a turn, and 180 degrees.
    let (rad, deg) =
        (end(VariableType::Float64, Some("rad")), end(VariableType::Float64, Some("deg")));
    let converted = through(&flat, &rad, &deg).unwrap().apply(std::f64::consts::PI).unwrap();
    assert!((converted - 180.0).abs() < 1e-12, "{converted}");
    // Without the conversion on the way out, the number is that of quarters.
    let suppressed = hierarchy(
        "heading",
        &connect("here.heading", "a.y", ""),
        &connect("b.u", "there.heading", "suppressUnitConversion=\"true\""),
    );
    let (_, flat) = read(&suppressed, &[("bus.ssb", BUS)]).unwrap();
    // The ends of connections may stand in either order.
    assert_eq!(wires(&flat), ["a.y -> mid.low.b.u"]);
    let quarters = through(&flat, &rad, &deg).unwrap().apply(std::f64::consts::PI).unwrap();
    assert!((quarters - 2.0).abs() < 1e-15, "{quarters}");
}

#[test]
fn a_dictionary_in_the_file_itself_and_version_2_are_read() {
    let inline = BUS
        .replace("<?xml version=\"1.0\" encoding=\"UTF-8\"?>", "")
        .replace("version=\"1.0\"", "version=\"2.0\"");
    let text = plain("heading").replace(
        r#"<SignalDictionary name="bus" source="bus.ssb"/>"#,
        &format!(r#"<SignalDictionary name="bus">{inline}</SignalDictionary>"#),
    );
    let (structure, flat) = read(&text, &[]).unwrap();
    assert_eq!(wires(&flat), ["a.y -> mid.low.b.u"]);
    let entries = &structure.system.dictionaries[0].entries;
    assert_eq!(entries.len(), 6);
    assert_eq!(entries[5].dimensions, [Some(3)]);
}

#[test]
fn one_writer_has_many_readers_and_the_nearest_dictionary_counts() {
    let own = r#"<SignalDictionaries><SignalDictionary name="bus">
        <ssb:SignalDictionary version="1.0"
            xmlns:ssb="http://ssp-standard.org/SSP1/SystemStructureSignalDictionary">
          <ssb:DictionaryEntry name="heading"><ssc:Real/></ssb:DictionaryEntry>
        </ssb:SignalDictionary></SignalDictionary></SignalDictionaries>"#;
    let (a, b) = (component("a", &format!("{IN}{OUT}"), ""), component("b", IN, ""));
    let both = |dictionaries: &str| {
        let inner = format!(
            r#"<System name="in"><Elements>{b}{}</Elements><Connections>{}</Connections>
               {dictionaries}</System>"#,
            reference("there", r#"<Connector name="heading" kind="output"/>"#),
            connect("there.heading", "b.u", "")
        );
        format!(
            r#"<System name="top"><Elements>{a}{}{inner}</Elements>
               <Connections>{}{}</Connections>{DICTIONARIES}</System>"#,
            reference("here", &inout("heading")),
            connect("a.y", "here.heading", ""),
            connect("here.heading", "a.u", ""),
        )
    };
    let (_, flat) = read(&both(""), &[("bus.ssb", BUS)]).unwrap();
    let mut found = wires(&flat);
    found.sort();
    assert_eq!(found, ["a.y -> a.u", "a.y -> in.b.u"]);
    // A dictionary of the inner system hides that of the outer one.
    let (_, flat) = read(&both(own), &[("bus.ssb", BUS)]).unwrap();
    assert_eq!(wires(&flat), ["a.y -> a.u"]);
    assert_eq!(flat.warnings.len(), 1, "{:?}", flat.warnings);
    assert!(
        flat.warnings[0].contains("the entry \"heading\" of the signal dictionary in.bus")
            && flat.warnings[0].contains("has a reader, in.b.u, and no writer"),
        "{:?}",
        flat.warnings
    );
}

#[test]
fn values_have_the_type_of_the_entry_on_their_way() {
    let float = end(VariableType::Float64, None);
    let flat = |entry: &str| read(&plain(entry), &[("bus.ssb", BUS)]).unwrap().1;
    let count = through(&flat("count"), &float, &float).unwrap();
    assert_eq!(count.apply(-7.0), Some(-7.0));
    for value in [2.5, 32_768.0, f64::NAN] {
        assert_eq!(count.apply(value), None, "{value}");
        let reason = count.misfit(value);
        assert!(
            reason.contains("the entry \"count\" of the signal dictionary bus")
                && reason.contains("bus.ssb:6) is a Int16 and has no such value"),
            "{reason}"
        );
    }
    let short = through(&flat("short"), &float, &float).unwrap();
    // 0.1 in binary32 is 13421773 / 2^27.
    assert_eq!(short.apply(0.1), Some(13_421_773.0 / 134_217_728.0));
    let whole = end(VariableType::Int32, None);
    let mode = through(&flat("mode"), &whole, &whole).unwrap();
    assert_eq!((mode.apply(4.0), mode.apply(3.0)), (Some(4.0), None));
    let text = end(VariableType::String, None);
    assert!(through(&flat("text"), &text, &text).is_ok());
    let error = through(&flat("text"), &float, &float).unwrap_err();
    assert!(error.starts_with("into the entry \"text\""), "{error}");
    assert!(error.ends_with("a Float64 can't become a String"), "{error}");
    let error = through(&flat("count"), &float, &text).unwrap_err();
    assert!(error.starts_with("out of the entry \"count\""), "{error}");
    let metres = end(VariableType::Float64, Some("m"));
    let error = through(&flat("heading"), &metres, &float).unwrap_err();
    assert!(error.contains("the unit \"m\"") && error.contains("\"quarter\""), "{error}");
}

#[test]
fn connectors_of_a_reference_are_those_of_the_entry() {
    let check = |entry: &str, inside: &str| {
        let connector = format!(r#"<Connector name="{entry}" kind="inout">{inside}</Connector>"#);
        let text = plain(entry).replacen(&inout(entry), &connector, 1);
        let (structure, flat) = read(&text, &[("bus.ssb", BUS)]).unwrap();
        references::check(&structure, &flat).map_err(|error| error.to_string())
    };
    for (entry, inside) in [
        ("heading", "<ssc:Real/>"),
        ("heading", "<ssc:Float32/>"),
        ("count", "<ssc:Integer/>"),
        ("three", "<ssc:Real/>"),
        ("three", "<ssc:Float64/><ssc:Dimension size=\"3\"/>"),
    ] {
        assert_eq!(check(entry, inside), Ok(()), "{entry} {inside}");
    }
    for (entry, inside, expected) in [
        (
            "heading",
            "<ssc:Boolean/>",
            "it is of type Boolean, and the entry of the signal dictionary bus is of type Real",
        ),
        ("count", "<ssc:Int32/>", "it is of type Int32"),
        (
            "heading",
            "<ssc:Real unit=\"deg\"/>",
            "it is in \"deg\", and the entry of the signal dictionary bus is in \"quarter\"",
        ),
        ("heading", "<ssc:Real unit=\"m\"/>", "the unit \"m\""),
        (
            "three",
            "<ssc:Float64/><ssc:Dimension size=\"2\"/>",
            "it has 2 elements, and the entry of the signal dictionary bus has 3",
        ),
    ] {
        let error = check(entry, inside).unwrap_err();
        assert!(error.contains(expected), "{error}");
        assert!(error.contains("SystemStructure.ssd:"), "{error}");
        assert!(error.contains(&format!("Connector \"{entry}\" of here")), "{error}");
    }
}

#[test]
fn an_entry_without_a_writer_takes_the_value_of_a_binding() {
    let bindings = r#"<ParameterBindings><ParameterBinding><ParameterValues>
        <ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
          <ssv:Parameter name="mid.low.there.heading"><ssv:Real value="2"/></ssv:Parameter>
        </ssv:Parameters></ssv:ParameterSet></ParameterValues></ParameterBinding>
        </ParameterBindings>"#;
    let text = hierarchy("heading", "", &connect("there.heading", "b.u", ""))
        .replace(r#"<System name="top">"#, &format!(r#"<System name="top">{bindings}"#));
    let (_, flat) = read(&text, &[("bus.ssb", BUS)]).unwrap();
    let given = &flat.components[1].parameters;
    assert_eq!((given[0].name.as_str(), &given[0].value.numbers[..]), ("u", &[2.0][..]));
    assert!(flat.warnings[0].contains("has a reader, mid.low.b.u, and no writer"));
}

#[test]
fn what_is_wrong_with_a_dictionary_is_told_with_file_and_line() {
    let good = plain("heading");
    let write = connect("a.y", "here.heading", "");
    let bus = |from: &str, to: &str| {
        assert!(BUS.contains(from), "{from}");
        BUS.replace(from, to)
    };
    let ssd = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replace(from, to)
    };
    let same = BUS.to_owned();
    for (structure, dictionary, expected) in [
        (
            hierarchy("heading", &write, &connect("b.y", "there.heading", "")),
            same.clone(),
            "SystemStructure.ssd:",
        ),
        (
            hierarchy("heading", &write, &connect("b.y", "there.heading", "")),
            same.clone(),
            "is written by a.y, and by mid.low.b.y in line",
        ),
        (
            hierarchy("heading", &connect("here.heading", "here.heading", ""), ""),
            same.clone(),
            "here.heading and here.heading are both of kind inout",
        ),
        (
            ssd(&inout("heading"), r#"<Connector name="heading" kind="input"/>"#),
            same.clone(),
            "there.heading and b.u both take values and none gives them",
        ),
        (
            ssd(&inout("heading"), &inout("headin")),
            same.clone(),
            "Connector \"headin\" of here: found no entry of this name in the signal dictionary bus",
        ),
        (
            ssd("name=\"bus\" source", "name=\"can\" source"),
            same.clone(),
            "SignalDictionaryReference \"here\": found the dictionary \"bus\", expected one of this \
             system or of those around it",
        ),
        (ssd("bus.ssb", "none.ssb"), same.clone(), "there is none of this name"),
        (ssd("source=\"bus.ssb\"", ""), same.clone(), "neither a source nor a <SignalDictionary>"),
        (
            ssd("source=\"bus.ssb\"", "source=\"bus.ssb\" type=\"text/plain\""),
            same.clone(),
            "the type \"text/plain\" was found, expected application/x-ssp-signal-dictionary",
        ),
        (
            ssd(r#"source="bus.ssb"/>"#, r#"source="bus.ssb"/><SignalDictionary name="bus"/>"#),
            same.clone(),
            "SignalDictionary \"bus\": found a second time",
        ),
        (
            good.clone(),
            bus("name=\"count\"", "name=\"heading\""),
            "bus.ssb:6: DictionaryEntry \"heading\": found a second time",
        ),
        (
            good.clone(),
            bus("<ssc:Int16/>", ""),
            "bus.ssb:6: DictionaryEntry \"count\": found no type",
        ),
        (good.clone(), bus("<ssc:Int16/>", "<ssc:Int16/><ssc:Real/>"), "found a second type"),
        (good.clone(), bus("<ssc:Int16/>", "<ssc:Clock/>"), "clocks are not part of this version"),
        (
            good.clone(),
            bus("Enumeration name=\"Mode\"/>", "Enumeration name=\"Mod\"/>"),
            "found the enumeration \"Mod\", expected one that the dictionary defines: its \
             <Enumerations> have \"Mode\"",
        ),
        (
            good.clone(),
            bus("ssb:SignalDictionary version=\"1.0\"", "ssb:SignalDictionary version=\"3.0\""),
            "bus.ssb:2: SignalDictionary: version \"3.0\" was found",
        ),
        (good.clone(), "<x/>".to_owned(), "bus.ssb:1: x: found <x> without namespace"),
        (good.clone(), BUS[..400].to_owned(), "not XML"),
        (good.clone(), bus("name=\"count\"", "nam=\"count\""), "unknown attribute \"nam\""),
    ] {
        let error = read(&structure, &[("bus.ssb", &dictionary)]).unwrap_err();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}
