//! Inputs with known content, run by the program: each count of an account is that of the input's construction, and the page
//! of accounts has a row for each. `OCTANT_WRITE_FIXTURES=1` writes the rows.

mod documents;
mod headings;
mod live;
mod logs;
mod mcap;
mod references;
mod rest;
mod solutions;
mod table;
mod text;
