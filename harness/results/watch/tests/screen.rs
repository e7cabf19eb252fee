//! The dashboard on a terminal of any size, as text.

use octant_watch::dashboard::{self, Page};
use octant_watch::follow::Follow;
use ratatui::Terminal;
use ratatui::backend::TestBackend;

pub(crate) fn screen(follow: &Follow, page: Page, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| dashboard::draw(frame, follow, page)).unwrap();
    terminal.backend().to_string()
}
