//! The links of a page in Markdown.

/// The targets of the links of `page` that are no addresses, without their anchors.
pub(crate) fn local(page: &str) -> impl Iterator<Item = &str> {
    let targets = page.split("](").skip(1).filter_map(|rest| rest.split_once(')').map(|(target, _)| target));
    let paths = targets.map(|target| target.split_once('#').map_or(target, |(path, _)| path));
    paths.filter(|path| !path.is_empty() && !path.contains("://"))
}

#[cfg(test)]
mod tests {
    use super::local;

    #[test]
    fn addresses_and_anchors_of_the_page_itself_are_left_out() {
        let page = "See [a](a.md), [b](../b/c.rs#part), [here](#here) and [there](https://example.org/x).";
        assert_eq!(local(page).collect::<Vec<_>>(), ["a.md", "../b/c.rs"]);
    }
}
