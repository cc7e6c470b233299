#pragma once

#include <string>
#include <utility>

#include "core/base/result.h"

namespace render {

template <typename Kind>
/// An OpenGL object that is deleted at the end of its life. `Kind` creates and deletes it.
class GlObject {
public:
    GlObject() = default;
    static GlObject make() {
        GlObject object;
        object.id_ = Kind::make();
        return object;
    }
    GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    GlObject(const GlObject&) = delete;
    GlObject& operator=(const GlObject&) = delete;
    ~GlObject() {
        if (id_ != 0) Kind::drop(id_);
    }

    unsigned id() const { return id_; }
    explicit operator bool() const { return id_ != 0; }

private:
    unsigned id_ = 0;
};

struct GlBufferKind {
    static unsigned make();
    static void drop(unsigned id);
};
struct GlVertexArrayKind {
    static unsigned make();
    static void drop(unsigned id);
};
struct GlTextureKind {
    static unsigned make();
    static void drop(unsigned id);
};
struct GlRenderbufferKind {
    static unsigned make();
    static void drop(unsigned id);
};
struct GlFramebufferKind {
    static unsigned make();
    static void drop(unsigned id);
};
struct GlProgramKind {
    static unsigned make();
    static void drop(unsigned id);
};

using GlBuffer = GlObject<GlBufferKind>;
using GlVertexArray = GlObject<GlVertexArrayKind>;
using GlTexture = GlObject<GlTextureKind>;
using GlRenderbuffer = GlObject<GlRenderbufferKind>;
using GlFramebuffer = GlObject<GlFramebufferKind>;
using GlProgram = GlObject<GlProgramKind>;

/// A program from the sources of its shaders.
///
/// Errors:  unsupported, with the message of the compiler.
core::Result<GlProgram> link_program(const std::string& vertex, const std::string& fragment);

} // namespace render
