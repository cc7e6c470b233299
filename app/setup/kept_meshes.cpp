#include "app/setup/kept_meshes.h"

#include <algorithm>
#include <array>
#include <list>
#include <mutex>
#include <optional>
#include <utility>

#include "app/base/sha256.h"

namespace app {
namespace {

constexpr size_t least_kept = 20'000, most_kept = 3'000'000; // triangles

using Digest = std::optional<std::array<unsigned char, 32>>;

/// Values by the digest of what they were made of; those used last stay.
template <typename T>
class Kept {
public:
    std::optional<T> find(const Digest& digest) {
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(values_.begin(), values_.end(),
                                        [&](const Value& value) { return value.digest == digest; });
        if (!digest || found == values_.end()) return std::nullopt;
        values_.splice(values_.begin(), values_, found);
        return found->value;
    }

    void add(const Digest& digest, T value, size_t triangles) {
        if (!digest || triangles < least_kept) return;
        const std::lock_guard lock(mutex_);
        values_.push_front({digest, std::move(value), triangles});
        size_t sum = 0;
        values_.remove_if([&](const Value& kept) { return (sum += kept.triangles) > most_kept; });
    }

private:
    struct Value {
        Digest digest;
        T value;
        size_t triangles;
    };

    std::mutex mutex_;
    std::list<Value> values_;
};

template <typename T>
std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

Digest digest_of(std::initializer_list<std::string_view> parts) {
    Sha256 sha;
    for (const std::string_view part : parts) sha.add(part);
    return sha.finish();
}

} // namespace

core::Result<std::shared_ptr<const core::MeshFile>> kept_mesh(const std::filesystem::path& path) {
    static Kept<std::shared_ptr<const core::MeshFile>> kept;
    FEELER_TRY(std::string bytes, core::read_mesh_bytes(path));
    // The format depends on the name, too.
    const Digest digest = digest_of({path.extension().generic_string(), bytes});
    if (auto found = kept.find(digest)) return *std::move(found);
    FEELER_TRY(core::MeshFile made, core::read_mesh(path, std::move(bytes)));
    auto file = std::make_shared<const core::MeshFile>(std::move(made));
    kept.add(digest, file, file->mesh.triangles.size());
    return file;
}

core::SolidMesh kept_solid(core::Mesh mesh) {
    static Kept<core::SolidMesh> kept;
    const size_t triangles = mesh.triangles.size();
    if (triangles < least_kept) return core::solid_mesh(std::move(mesh));
    const Digest digest = digest_of({bytes_of(mesh.vertices), bytes_of(mesh.triangles)});
    if (auto found = kept.find(digest)) return *std::move(found);
    core::SolidMesh solid = core::solid_mesh(std::move(mesh));
    kept.add(digest, solid, triangles);
    return solid;
}

} // namespace app
