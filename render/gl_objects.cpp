#include "render/gl_objects.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace render {
namespace {

GlProgram linked(unsigned vertex, unsigned fragment) {
    GlProgram program = GlProgram::make();
    glAttachShader(program.id(), vertex);
    glAttachShader(program.id(), fragment);
    glLinkProgram(program.id());
    return program;
}

struct Shader {
    unsigned id;
    explicit Shader(GLenum kind) : id(glCreateShader(kind)) {}
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;
    ~Shader() { glDeleteShader(id); }
};

core::Result<void> compile(const Shader& shader, const std::string& text) {
    const char* begin = text.c_str();
    glShaderSource(shader.id, 1, &begin, nullptr);
    glCompileShader(shader.id);
    GLint ok = 0;
    glGetShaderiv(shader.id, GL_COMPILE_STATUS, &ok);
    if (ok != 0) return {};
    std::string report(2000, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader.id, static_cast<GLsizei>(report.size()), &length, report.data());
    report.resize(static_cast<size_t>(length));
    return core::fail(core::ErrorCode::unsupported,
                      fmt::format("the graphics driver rejects a shader: {}", report));
}

} // namespace

#define FEELER_GL_KIND(Kind, plural)                                                               \
    unsigned Kind::make() {                                                                        \
        unsigned id = 0;                                                                           \
        glGen##plural(1, &id);                                                                     \
        return id;                                                                                 \
    }                                                                                              \
    void Kind::drop(unsigned id) { glDelete##plural(1, &id); }

FEELER_GL_KIND(GlBufferKind, Buffers)
FEELER_GL_KIND(GlVertexArrayKind, VertexArrays)
FEELER_GL_KIND(GlTextureKind, Textures)
FEELER_GL_KIND(GlRenderbufferKind, Renderbuffers)
FEELER_GL_KIND(GlFramebufferKind, Framebuffers)

#undef FEELER_GL_KIND

unsigned GlProgramKind::make() { return glCreateProgram(); }
void GlProgramKind::drop(unsigned id) { glDeleteProgram(id); }

core::Result<GlProgram> link_program(const std::string& vertex, const std::string& fragment) {
    const Shader upper(GL_VERTEX_SHADER), lower(GL_FRAGMENT_SHADER);
    if (auto made = compile(upper, vertex); !made) return tl::unexpected(made.error());
    if (auto made = compile(lower, fragment); !made) return tl::unexpected(made.error());
    GlProgram program = linked(upper.id, lower.id);
    GLint ok = 0;
    glGetProgramiv(program.id(), GL_LINK_STATUS, &ok);
    if (ok == 0)
        return core::fail(core::ErrorCode::unsupported,
                          "the graphics driver cannot link a shader program");
    return program;
}

} // namespace render
