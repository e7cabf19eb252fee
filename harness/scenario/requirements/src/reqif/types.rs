//! Types of a ReqIF file: enumerations, and attributes of objects.

use octant_verdict::requirement::AttributeKind;
use roxmltree::Node;
use std::collections::HashMap;

/// First child with a name.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|n| n.tag_name().name() == name)
}

/// Elements in the first child with a name.
pub(super) fn within<'a, 'i>(
    node: Node<'a, 'i>,
    name: &str,
) -> impl Iterator<Item = Node<'a, 'i>> + use<'a, 'i> {
    child(node, name).into_iter().flat_map(|n| n.children()).filter(Node::is_element)
}

/// Text of the single element in a child with a name: a reference.
pub(super) fn reference<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    within(node, name).next().and_then(|n| n.text()).map(str::trim)
}

/// An attribute of an object type.
pub(super) struct Definition {
    pub(super) name: String,
    pub(super) kind: AttributeKind,
}

/// An object type.
pub(super) struct ObjectType {
    pub(super) name: String,
    /// Identifiers of the type's attributes.
    pub(super) attributes: Vec<String>,
}

/// All types of a file.
#[derive(Default)]
pub(super) struct Types {
    /// Attributes by identifier.
    pub(super) attributes: HashMap<String, Definition>,
    pub(super) objects: HashMap<String, ObjectType>,
    /// Names of relation types, by identifier.
    pub(super) relations: HashMap<String, String>,
    /// Options, by the identifier of their value.
    pub(super) options: HashMap<String, String>,
}

/// Line and text of an error.
pub(super) type Wrong = (usize, String);

impl Types {
    /// Reads the types of a file, and lists the definitions that can't be used.
    pub(super) fn read(
        content: Node<'_, '_>,
        line: &dyn Fn(Node<'_, '_>) -> usize,
    ) -> (Self, Vec<Wrong>) {
        let (mut types, mut undefined) = (Self::default(), Vec::new());
        let mut enumerations: HashMap<&str, Vec<String>> = HashMap::new();
        for datatype in within(content, "DATATYPES") {
            if datatype.tag_name().name() != "DATATYPE-DEFINITION-ENUMERATION" {
                continue;
            }
            let mut options = Vec::new();
            for value in within(datatype, "SPECIFIED-VALUES") {
                let id = match identifier(value, line) {
                    Ok(id) => id,
                    Err(wrong) => {
                        undefined.push(wrong);
                        continue;
                    }
                };
                let key = || within(value, "PROPERTIES").next().and_then(|p| p.attribute("KEY"));
                let name =
                    value.attribute("LONG-NAME").filter(|n| !n.trim().is_empty()).or_else(key);
                let name = name.unwrap_or(id).trim().to_owned();
                types.options.insert(id.to_owned(), name.clone());
                options.push(name);
            }
            match identifier(datatype, line) {
                Ok(id) => _ = enumerations.insert(id, options),
                Err(wrong) => undefined.push(wrong),
            }
        }
        for node in within(content, "SPEC-TYPES") {
            let id = match identifier(node, line) {
                Ok(id) => id,
                Err(wrong) => {
                    undefined.push(wrong);
                    continue;
                }
            };
            let name = node.attribute("LONG-NAME").unwrap_or(id).to_owned();
            match node.tag_name().name() {
                "SPEC-RELATION-TYPE" => _ = types.relations.insert(id.to_owned(), name),
                "SPEC-OBJECT-TYPE" => {
                    let attributes = types.attributes_of(node, &enumerations, line, &mut undefined);
                    types.objects.insert(id.to_owned(), ObjectType { name, attributes });
                }
                "SPECIFICATION-TYPE" => {
                    types.attributes_of(node, &enumerations, line, &mut undefined);
                }
                // Attributes of relations are not supported.
                _ => {}
            }
        }
        (types, undefined)
    }

    fn attributes_of(
        &mut self,
        node: Node<'_, '_>,
        enumerations: &HashMap<&str, Vec<String>>,
        line: &dyn Fn(Node<'_, '_>) -> usize,
        undefined: &mut Vec<Wrong>,
    ) -> Vec<String> {
        let mut attributes = Vec::new();
        for attribute in within(node, "SPEC-ATTRIBUTES") {
            let id = match identifier(attribute, line) {
                Ok(id) => id,
                Err(wrong) => {
                    undefined.push(wrong);
                    continue;
                }
            };
            let name = attribute.attribute("LONG-NAME").unwrap_or(id).trim().to_owned();
            let tag = attribute.tag_name().name();
            let kind = match tag.strip_prefix("ATTRIBUTE-DEFINITION-") {
                Some("STRING" | "XHTML") => AttributeKind::Text,
                Some("INTEGER") => AttributeKind::Integer,
                Some("REAL") => AttributeKind::Real,
                Some("BOOLEAN") => AttributeKind::Boolean,
                Some("DATE") => AttributeKind::Date,
                Some("ENUMERATION") => {
                    let datatype = reference(attribute, "TYPE").unwrap_or_default();
                    let Some(options) = enumerations.get(datatype) else {
                        let found =
                            format!("the attribute {name:?} is of an enumeration {datatype:?}");
                        undefined
                            .push((line(attribute), format!("{found} that isn't in the file")));
                        continue;
                    };
                    match attribute.attribute("MULTI-VALUED") {
                        Some("true" | "1") => AttributeKind::Choices(options.clone()),
                        _ => AttributeKind::Choice(options.clone()),
                    }
                }
                _ => {
                    let message = format!("found {tag}, expected an ATTRIBUTE-DEFINITION");
                    undefined.push((line(attribute), message));
                    continue;
                }
            };
            self.attributes.insert(id.to_owned(), Definition { name, kind });
            attributes.push(id.to_owned());
        }
        attributes
    }
}

/// Identifier, which every element of ReqIF has.
pub(super) fn identifier<'a>(
    node: Node<'a, '_>,
    line: &dyn Fn(Node<'_, '_>) -> usize,
) -> Result<&'a str, Wrong> {
    node.attribute("IDENTIFIER")
        .filter(|id| !id.is_empty())
        .ok_or_else(|| (line(node), format!("{} has no IDENTIFIER", node.tag_name().name())))
}
