//! Renderer points.
