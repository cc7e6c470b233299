#pragma once

#include <memory>

#include "core/base/result.h"

namespace render {

/// An OpenGL 3.3 core context without a window or a screen; current for the thread that made it
/// until it ends.
class Offscreen {
public:
    /// Errors: unsupported, saying what is missing and which package has it.
    static core::Result<Offscreen> make();

    /// Makes it current again, after another context was.
    core::Result<void> make_current();

private:
    struct Context;
    explicit Offscreen(std::shared_ptr<Context> context) : context_(std::move(context)) {}

    std::shared_ptr<Context> context_;
};

} // namespace render
