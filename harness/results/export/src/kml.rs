//! KML for maps: the track of the navigation solution and the true one, with times.
//!
//! A track is a `gx:Track` (an extension that Google Earth reads, and GDAL for QGIS): all times, then all
//! points. Times of KML are dates: run time counts from 1970-01-01T00:00:00Z. Heights are left out,
//! because viewers take them from sea level, not from the ellipsoid; the tracks lie on the ground.

use super::error::ExportFailure;
use super::job::{EXPORT_VERSION, Job, NewFile};
use super::rows::each_row;
use super::table::{Cell, Table};
use octant_base::printable::printable;
use octant_sample::Mode;
use octant_views::solution::is_solution;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::time::{Duration, UNIX_EPOCH};

/// A track: its name, style, and the columns of its points.
struct Track {
    name: &'static str,
    style: &'static str,
    /// aabbggrr, as KML has it.
    colour: &'static str,
    latitude: &'static str,
    longitude: &'static str,
}

const TRACKS: [Track; 2] = [
    Track {
        name: "truth",
        style: "truth",
        colour: "ff3c9f2c",
        latitude: "true_latitude_deg",
        longitude: "true_longitude_deg",
    },
    Track {
        name: "navigation",
        style: "navigation",
        colour: "ffb4771f",
        latitude: "latitude_deg",
        longitude: "longitude_deg",
    },
];

/// Writes the file.
pub(crate) fn write(job: &Job<'_>) -> Result<Vec<PathBuf>, ExportFailure> {
    let points = |track: &Track, take: &mut dyn FnMut(Point)| points(job, track, take);
    let mut counts = [0u64; 2];
    for (track, count) in TRACKS.iter().zip(&mut counts) {
        points(track, &mut |_| *count += 1)?;
    }
    if counts == [0; 2] {
        return Err(ExportFailure::Nothing {
            path: job.choice.recording.clone(),
            reason: "it has no solution: the core neither calibrated nor navigated".to_owned(),
        });
    }
    let new = NewFile::create(job.out, job.force)?;
    let mut xml = Xml(Writer::new_with_indent(BufWriter::new(new.file()?), b' ', 1));
    xml.begin(job).map_err(|error| new.system(error))?;
    for (track, count) in TRACKS.iter().zip(counts).filter(|(_, count)| *count > 0) {
        xml.track_begins(track, count).map_err(|error| new.system(error))?;
        for part in [Part::Times, Part::Points] {
            let mut failed = None;
            points(track, &mut |point| {
                if failed.is_none() {
                    failed = xml.point(part, &point).err();
                }
            })?;
            failed.map_or(Ok(()), |error| Err(new.system(error)))?;
        }
        xml.track_ends().map_err(|error| new.system(error))?;
    }
    xml.end().map_err(|error| new.system(error))?;
    Ok(vec![new.finish()?])
}

/// Point of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    time_s: f64,
    latitude_deg: f64,
    longitude_deg: f64,
}

/// Half of a track: all times stand before all points.
#[derive(Clone, Copy)]
enum Part {
    Times,
    Points,
}

/// Passes on the points of a track: those of calibration and navigation.
fn points(job: &Job<'_>, track: &Track, take: &mut dyn FnMut(Point)) -> Result<(), ExportFailure> {
    let Some(table) = job.survey.table(Table::Navigation) else { return Ok(()) };
    let place = |name: &str| {
        table.columns.iter().find(|found| found.column.name == name).map(|found| found.place)
    };
    let (Some(mode), Some(latitude), Some(longitude)) =
        (place("mode"), place(track.latitude), place(track.longitude))
    else {
        return Ok(());
    };
    each_row(job.choice, &mut |table, cells| {
        let known = Mode::ALL
            .into_iter()
            .find(|known| table == Table::Navigation && cells[mode] == Cell::from(*known as u8));
        if known.is_some_and(is_solution) {
            let point = Point {
                time_s: cells[0].as_f64(),
                latitude_deg: cells[latitude].as_f64(),
                longitude_deg: wrapped(cells[longitude].as_f64()),
            };
            if point.latitude_deg.is_finite() && point.longitude_deg.is_finite() {
                take(point);
            }
        }
        Ok(())
    })
    .map(|_| ())
}

/// Longitude within ±180°.
fn wrapped(longitude_deg: f64) -> f64 {
    let turns = libm::floor((longitude_deg + 180.0) / 360.0);
    longitude_deg - 360.0 * turns
}

/// Run time as a date of KML.
fn date(time_s: f64) -> String {
    let time = UNIX_EPOCH + Duration::from_nanos((time_s.max(0.0) * 1e9).round() as u64);
    octant_base::utc::millis(time)
}

struct Xml<W: Write>(Writer<W>);

impl<W: Write> Xml<W> {
    fn put(&mut self, event: Event<'_>) -> std::io::Result<()> {
        self.0.write_event(event)
    }

    fn open(&mut self, name: &str, attributes: &[(&str, &str)]) -> std::io::Result<()> {
        self.put(Event::Start(BytesStart::new(name).with_attributes(attributes.iter().copied())))
    }

    fn close(&mut self, name: &str) -> std::io::Result<()> {
        self.put(Event::End(BytesEnd::new(name)))
    }

    fn text(&mut self, name: &str, words: &str) -> std::io::Result<()> {
        self.open(name, &[])?;
        self.put(Event::Text(BytesText::new(&printable(words))))?;
        self.close(name)
    }

    fn begin(&mut self, job: &Job<'_>) -> std::io::Result<()> {
        self.put(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        self.open(
            "kml",
            &[
                ("xmlns", "http://www.opengis.net/kml/2.2"),
                ("xmlns:gx", "http://www.google.com/kml/ext/2.2"),
            ],
        )?;
        self.open("Document", &[])?;
        let name = job.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.text("name", &name)?;
        self.text(
            "description",
            &format!(
                "Written by octant {}, export version {EXPORT_VERSION}. Times are run time, counted \
                 from 1970-01-01.",
                env!("CARGO_PKG_VERSION")
            ),
        )?;
        for track in &TRACKS {
            self.open("Style", &[("id", track.style)])?;
            self.open("LineStyle", &[])?;
            self.text("color", track.colour)?;
            self.text("width", "2")?;
            self.close("LineStyle")?;
            self.close("Style")?;
        }
        Ok(())
    }

    fn track_begins(&mut self, track: &Track, count: u64) -> std::io::Result<()> {
        self.open("Placemark", &[])?;
        self.text("name", track.name)?;
        self.text("description", &format!("{count} points"))?;
        self.text("styleUrl", &format!("#{}", track.style))?;
        self.open("gx:Track", &[])?;
        self.text("altitudeMode", "clampToGround")
    }

    fn point(&mut self, part: Part, point: &Point) -> std::io::Result<()> {
        match part {
            Part::Times => self.text("when", &date(point.time_s)),
            // A hundred-millionth of a degree is a millimetre.
            Part::Points => self.text(
                "gx:coord",
                &format!("{:.9} {:.9} 0", point.longitude_deg, point.latitude_deg),
            ),
        }
    }

    fn track_ends(&mut self) -> std::io::Result<()> {
        self.close("gx:Track")?;
        self.close("Placemark")
    }

    fn end(mut self) -> std::io::Result<()> {
        self.close("Document")?;
        self.close("kml")?;
        self.0.get_mut().flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn longitudes_are_within_half_a_turn() {
        for (unwrapped, wanted) in [
            (0.0, 0.0),
            (179.0, 179.0),
            (181.0, -179.0),
            (-181.0, 179.0),
            (-540.0, -180.0),
            (725.0, 5.0),
        ] {
            assert_eq!(wrapped(unwrapped), wanted, "{unwrapped}");
        }
    }

    #[test]
    fn run_time_counts_from_the_first_of_january_1970() {
        assert_eq!(date(0.0), "1970-01-01T00:00:00.000Z");
        assert_eq!(date(86_400.0 + 3723.25), "1970-01-02T01:02:03.250Z");
    }
}
