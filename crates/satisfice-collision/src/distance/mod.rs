//! Distances between features: points, segments and triangles.
