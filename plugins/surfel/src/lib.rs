//! Renderer surfel.
