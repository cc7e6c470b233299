#pragma once

// The folder of Debian's package.
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
