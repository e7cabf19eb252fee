//! Order and nesting of sections and requirements.

use octant_verdict::requirement::Requirements;

/// A step through the hierarchy of a document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step<'a> {
    /// Begins the section with this title and number.
    Section(&'a str, usize),
    /// Begins the requirement with this index.
    Requirement(usize),
    /// Ends the innermost section or requirement.
    End,
}

/// Steps through all requirements, in their order.
pub(crate) fn steps(requirements: &Requirements) -> Vec<Step<'_>> {
    let mut steps = Vec::new();
    let mut open: Vec<Step<'_>> = Vec::new();
    let mut sections = 0;
    let all = &requirements.requirements;
    for (index, requirement) in all.iter().enumerate() {
        let is_above = |step: &Step<'_>| matches!(step, Step::Requirement(at) if Some(&all[*at].id) == requirement.under.as_ref());
        let above = open.iter().position(is_above).map_or(0, |at| at + 1);
        let titles = |steps: &[Step<'_>]| {
            let titles = steps.iter().filter(|step| matches!(step, Step::Section(..)));
            titles.count()
        };
        // A requirement in another section than the one that it stands below is not below it.
        let fits = open[..above].iter().filter_map(|step| match step {
            Step::Section(title, _) => Some(*title),
            _ => None,
        });
        let fits =
            fits.eq(requirement.section.iter().take(titles(&open[..above])).map(String::as_str));
        let mut kept = if fits { above } else { 0 };
        let mut named = titles(&open[..kept]);
        while let (Some(Step::Section(title, _)), Some(wanted)) =
            (open.get(kept), requirement.section.get(named))
        {
            if title != wanted {
                break;
            }
            kept += 1;
            named += 1;
        }
        steps.extend(std::iter::repeat_n(Step::End, open.len() - kept));
        open.truncate(kept);
        for title in &requirement.section[named..] {
            open.push(Step::Section(title, sections));
            steps.push(Step::Section(title, sections));
            sections += 1;
        }
        open.push(Step::Requirement(index));
        steps.push(Step::Requirement(index));
    }
    steps.extend(std::iter::repeat_n(Step::End, open.len()));
    steps
}
