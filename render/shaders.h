#pragma once

namespace render::shaders {

// GLSL 3.30. Inputs are documented at each source.
extern const char* const background_vertex;
extern const char* const background_fragment;
extern const char* const mesh_vertex;
extern const char* const mesh_fragment;
extern const char* const edge_vertex;
extern const char* const edge_fragment;
extern const char* const line_vertex;
extern const char* const line_fragment;
extern const char* const cap_vertex;
extern const char* const cap_fragment;
extern const char* const shadow_vertex;
extern const char* const shadow_fragment;
extern const char* const grid_vertex;
extern const char* const grid_fragment;
extern const char* const hollow_fragment;
extern const char* const smooth_fragment;

} // namespace render::shaders
