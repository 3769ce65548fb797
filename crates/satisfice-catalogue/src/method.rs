//! The exact methods, by name.

/// A method that finds all hits of a problem of vertex pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Method {
    /// Its name, used like the name of an engine.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// The publication.
    pub reference: &'static str,
}

/// All of them.
pub static METHODS: &[Method] = &[
    Method {
        name: "aabb",
        summary: "exact: trees of axis-aligned boxes, built and traversed in pairs; an evaluation is a pair of leaves whose boxes are near",
        reference: "van den Bergen 1997, doi 10.1080/10867651.1997.10487480",
    },
    Method {
        name: "grid",
        summary: "exact: a uniform grid clipped to the overlap; an evaluation is a squared distance computed",
        reference: "none needed",
    },
    Method {
        name: "brute-force",
        summary: "exact: the distance of every pair",
        reference: "none needed",
    },
];

/// The method with this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Method> {
    METHODS.iter().find(|method| method.name == name)
}
