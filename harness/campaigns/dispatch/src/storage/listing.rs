//! Lists of objects in pages, which end even if the storage never says so.

use object_store::aws::AmazonS3;
use object_store::list::{PaginatedListOptions, PaginatedListStore};
use object_store::{Error, ObjectMeta};
use std::collections::BTreeSet;

/// Most objects of a campaign. One worker that uploads every 20 s makes as many in 8 months.
pub(crate) const OBJECTS_MAX: usize = 1_000_000;
/// Most pages of a list. A page has up to 1000 objects.
const PAGES_MAX: usize = 10_000;

/// Reads every page of a list; the inner error says why it doesn't end.
pub(crate) async fn pages(
    store: &AmazonS3,
    prefix: Option<&str>,
) -> Result<Result<Vec<ObjectMeta>, String>, Error> {
    let mut all = Vec::new();
    let mut tokens = BTreeSet::new();
    let mut page_token = None;
    loop {
        let options = PaginatedListOptions { page_token, ..PaginatedListOptions::default() };
        let page = store.list_paginated(prefix, options).await?;
        all.extend(page.result.objects);
        let Some(next) = page.page_token else { return Ok(Ok(all)) };
        if all.len() > OBJECTS_MAX {
            return Ok(Err(format!(
                "found more than {OBJECTS_MAX} objects in the list, expected those of one campaign"
            )));
        }
        if !tokens.insert(next.clone()) {
            return Ok(Err(format!(
                "found a list that leads from page {} back to an earlier one, expected one that ends",
                tokens.len() + 1
            )));
        }
        if tokens.len() >= PAGES_MAX {
            return Ok(Err(format!(
                "found a list of more than {PAGES_MAX} pages, expected one that ends"
            )));
        }
        page_token = Some(next);
    }
}
