#pragma once

#include "render/gpu_meshes.h"
#include "render/view_frame.h"

namespace render {

/// Draws what is solid: bodies, stock, faces of a section.
class BodyPass {
public:
    static core::Result<BodyPass> make();

    void draw_opaque(const ViewFrame& frame);
    /// The depths of what is opaque, and nothing else.
    void draw_depths(const ViewFrame& frame);
    /// What is seen through, the farthest first. Needs what is opaque to be there.
    void draw_glass(const ViewFrame& frame);
    /// A ball of so many pixels that nothing hides.
    void draw_mark(const ViewFrame& frame, const Vec3& at, double pixels, Color color);
    void end_picture() { meshes_.end_picture(); }

private:
    /// A body or the stock, as it is drawn.
    struct Item {
        const Body* body = nullptr; // null: the stock
        core::Transform pose;
        core::Aabb box; // in the scene
        Color color, second;
        double alpha = 1.0;
        bool cut = false; // by the section plane
        bool closed = true;
    };

    Item item(const ViewFrame& frame, const Body& body, bool is_ghost) const;
    Item stock_item(const ViewFrame& frame) const;
    std::vector<Item> opaque_items(const ViewFrame& frame) const;
    void set_material(const ViewFrame& frame, const Item& item, bool glass) const;
    void draw_faces(const ViewFrame& frame, const Item& item);
    void draw_edges(const ViewFrame& frame, const Item& item);
    void draw_cap(const ViewFrame& frame, const Item& item);
    template <typename Act>
    /// `whole`: of a stock every triangle, not what is drawn in their place.
    void for_meshes(const ViewFrame& frame, const Item& item, const Act& act, bool whole = false);

    ShaderProgram faces_, edges_, caps_;
    GpuMeshes meshes_;
    GlVertexArray no_attributes_;
    SharedMesh ball_;
};

} // namespace render
