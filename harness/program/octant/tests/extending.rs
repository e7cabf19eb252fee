//! The page on extending: its counts are those of its tables, and stay low.

use regex::Regex;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/extending.md");

/// Most places of an addition, where that is limited.
const MOST: [(&str, usize); 3] = [("A kind of fault", 4), ("An instrument", 5), ("A port", 5)];

#[test]
fn the_tables_are_as_long_as_the_page_says() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let summary =
        Regex::new(r"(?m)^\| \[[^]]+\]\(#([a-z-]+)\) \| (\d+) \| (\d+) \| (\d+) \| (\d+) \|$")
            .unwrap();
    let row = Regex::new(r"(?m)^\| (\d+) \|").unwrap();
    let mut tables = 0;
    for section in page.split("\n## ").flat_map(|part| part.split("\n### ")).skip(1) {
        let title = section.lines().next().unwrap();
        let anchor = title.to_lowercase().replace(' ', "-");
        let Some(counts) = summary.captures_iter(&page).find(|row| row[1] == anchor) else {
            continue;
        };
        tables += 1;
        let [source, tests, documents, all] =
            [2, 3, 4, 5].map(|column| counts[column].parse::<usize>().unwrap());
        assert_eq!(source + tests + documents, all, "{title}");
        let rows = row.captures_iter(section);
        let numbers: Vec<usize> = rows.map(|row| row[1].parse().unwrap()).collect();
        assert_eq!(numbers, (1..=all).collect::<Vec<_>>(), "{title}");
        if let Some((_, most)) = MOST.iter().find(|(limited, _)| *limited == title) {
            assert!(all <= *most, "{title} has {all} places, {most} are allowed");
        }
    }
    assert_eq!(tables, summary.captures_iter(&page).count());
    for (title, _) in MOST {
        assert!(page.contains(&format!("# {title}\n")), "{title}");
    }
}
