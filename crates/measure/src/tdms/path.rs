//! Paths of objects: `/` is the file, `/'group'`, `/'group'/'channel'`.

/// What an object is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Path {
    File,
    Group(String),
    Channel(String, String),
}

impl Path {
    /// Takes a path apart; a quote within a name is written twice.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        if text == "/" {
            return Some(Self::File);
        }
        let (group, rest) = name(text)?;
        if rest.is_empty() {
            return Some(Self::Group(group));
        }
        let (channel, rest) = name(rest)?;
        rest.is_empty().then_some(Self::Channel(group, channel))
    }
}

/// The first name of a path, and what follows it.
fn name(text: &str) -> Option<(String, &str)> {
    let mut rest = text.strip_prefix("/'")?;
    let mut name = String::new();
    loop {
        let (before, after) = rest.split_once('\'')?;
        name.push_str(before);
        match after.strip_prefix('\'') {
            Some(_) => name.push('\''),
            None => return Some((name, after)),
        }
        rest = &after[1..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_quotes_and_slashes() {
        let channel = |group: &str, name: &str| Some(Path::Channel(group.into(), name.into()));
        assert_eq!(Path::parse("/"), Some(Path::File));
        assert_eq!(Path::parse("/'Hits'"), Some(Path::Group("Hits".into())));
        assert_eq!(Path::parse("/'Hits'/'Force'"), channel("Hits", "Force"));
        assert_eq!(Path::parse("/'Dr. T''s'/'a/b'"), channel("Dr. T's", "a/b"));
        assert_eq!(Path::parse("/''''/'''a'''''"), channel("'", "'a''"));
        assert_eq!(Path::parse("/''/''"), channel("", ""));
        for wrong in ["", "Hits", "/Hits", "/'Hits", "/'a'b", "/'a'/'b'/'c'", "//", "/'a'/", "/'''"]
        {
            assert_eq!(Path::parse(wrong), None, "{wrong}");
        }
    }
}
