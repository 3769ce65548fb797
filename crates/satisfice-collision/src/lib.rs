//! satisfice-collision
