//! Licences of an FMU: Octant's own, and those of the components of its library.

use super::archive::File;
use std::fmt::Write;

/// Copyright notice of LICENSE-MIT.
pub(super) const COPYRIGHT: &str = "Copyright (c) 2026 The Octant developers";

const MIT: &str = include_str!("../../../../LICENSE-MIT");
const APACHE: &str = include_str!("../../../../LICENSE-APACHE");

/// Crates that are linked into the library: name, version, licence. A test compares the list with
/// cargo's.
const COMPONENTS: &str = include_str!("components.txt");

/// Notices that MIT-licensed components require; the others are used under Apache-2.0.
const NOTICES: &str = "\
libm (MIT):
  Copyright (c) 2018 Jorge Aparicio
  Derived from musl libc, Copyright (c) 2005-2020 Rich Felker, et al., much of whose math library is
  Copyright (c) 1993, 2004 Sun Microsystems, 2003-2011 David Schultz, 2003-2009 Steven G. Kargl,
  2003-2009 Bruce D. Evans, 2008 Stephen L. Moshier, 2017-2018 Arm Limited;
  and from the CORE-MATH project.
The Rust standard library (MIT OR Apache-2.0):
  Copyright (c) The Rust Project contributors
";

/// Builds the folder `documentation/licenses` of an FMU.
pub(super) fn files(name: &str) -> Vec<File> {
    let file = |name: &str, text: String| File::new(format!("documentation/licenses/{name}"), text);
    vec![
        file("LICENSE-APACHE.txt", APACHE.to_owned()),
        file("LICENSE-MIT.txt", MIT.to_owned()),
        file("license.spdx", spdx(name)),
        file("license.txt", overview()),
    ]
}

fn components() -> impl Iterator<Item = [&'static str; 3]> {
    COMPONENTS.lines().filter_map(|line| {
        let mut words = line.splitn(3, ' ');
        Some([words.next()?, words.next()?, words.next()?])
    })
}

fn overview() -> String {
    let mut text = format!(
        "{COPYRIGHT}\n\n\
         This FMU is licensed under either of the Apache License, Version 2.0 (LICENSE-APACHE.txt)\n\
         or the MIT license (LICENSE-MIT.txt) at your option.\n\n\
         Its library contains these components, each under the licence named:\n\n"
    );
    for [name, version, licence] in components() {
        // Writing to a String can't fail.
        let _ = writeln!(text, "  {name} {version}: {licence}");
    }
    text + "\n" + NOTICES
}

/// Builds an SPDX 2.3 document in tag-value form. The time of creation is that of the archive's
/// files.
fn spdx(name: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let mut text = format!(
        "SPDXVersion: SPDX-2.3\n\
         DataLicense: CC0-1.0\n\
         SPDXID: SPDXRef-DOCUMENT\n\
         DocumentName: {name}\n\
         DocumentNamespace: urn:octant:{name}:{version}\n\
         Creator: Tool: octant-{version}\n\
         Created: 1980-01-01T00:00:00Z\n\
         Relationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-fmu\n"
    );
    let mut package = |id: &str, name: &str, version: &str, licence: &str, copyright: &str| {
        let _ = write!(
            text,
            "\nPackageName: {name}\n\
             SPDXID: SPDXRef-{id}\n\
             PackageVersion: {version}\n\
             PackageDownloadLocation: NOASSERTION\n\
             FilesAnalyzed: false\n\
             PackageLicenseConcluded: {licence}\n\
             PackageLicenseDeclared: {licence}\n\
             PackageCopyrightText: {copyright}\n"
        );
        if id != "fmu" {
            let _ = writeln!(text, "Relationship: SPDXRef-fmu CONTAINS SPDXRef-{id}");
        }
    };
    let own = format!("<text>{COPYRIGHT}</text>");
    package("fmu", name, version, env!("CARGO_PKG_LICENSE"), &own);
    for [name, version, licence] in components() {
        // An SPDX identifier allows letters, digits, dots and hyphens only.
        package(&name.replace('_', "-"), name, version, licence, "NOASSERTION");
    }
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn components_are_those_that_cargo_links() {
        let tree = octant_test_processes::command(env!("CARGO"))
            .args([
                "tree",
                "--offline",
                "--package",
                "octant-fmu",
                "--edges",
                "normal,no-proc-macro",
            ])
            .args(["--prefix", "none", "--format", "{p}|{l}|"])
            .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../.."))
            .output()
            .unwrap();
        assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
        let tree = String::from_utf8(tree.stdout).unwrap();
        let linked: BTreeSet<String> = tree
            .lines()
            .filter(|line| !line.starts_with("octant-"))
            .map(|line| {
                let (package, rest) = line.split_once('|').unwrap();
                let (name, version) = package.split_once(" v").unwrap();
                format!("{name} {version} {}", rest.split_once('|').unwrap().0)
            })
            .collect();
        let listed: BTreeSet<String> = COMPONENTS.lines().map(str::to_owned).collect();
        assert_eq!(listed, linked, "components.txt has to be what is linked");
        assert_eq!(components().count(), listed.len());
    }

    #[test]
    fn what_is_not_under_apache_has_its_notice() {
        for [name, _, licence] in components() {
            assert!(
                licence.contains("Apache-2.0") || NOTICES.contains(&format!("{name} ({licence}):")),
                "{name} is under {licence} alone"
            );
        }
    }

    #[test]
    fn copyright_is_that_of_the_licence() {
        assert!(MIT.contains(COPYRIGHT));
    }
}
