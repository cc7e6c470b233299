#pragma once

// Where Debian's package puts them.
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
