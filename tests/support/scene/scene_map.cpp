// GPL-2.0-or-later. Writes a scene as a map source.
#include "common/error.h"
#include "tests/support/scene/scene_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace q3 {

namespace {

using Box = SceneBuilder::Box;

constexpr int kDetailFlag = 1 << 27;              ///< contents flag of a side: its brush is detail
constexpr float kStepsPerUnit = 8;                ///< of coordinates that the bsp stage keeps exactly
constexpr float kMaxCoordinate = 60000;           ///< chosen: within the world of 65536 units, with room for walls
constexpr std::string_view kFolder = "textures/"; ///< prefix of all shaders, omitted in map sources

bool IsPlain(const SceneShader &shader) {
    return shader.name.starts_with(kFolder) && shader == SceneShader{shader.name};
}

/// Whether the bsp stage keeps the coordinates exactly: it rounds vertices.
bool IsOnGrid(const Vec3f &p) {
    for (std::size_t axis = 0; axis < 3; axis++)
        if (p[axis] * kStepsPerUnit != std::nearbyint(p[axis] * kStepsPerUnit) || std::abs(p[axis]) > kMaxCoordinate)
            return false;
    return true;
}

bool IsPlain(const Box &box) {
    return IsOnGrid(box.bounds.mins) && IsOnGrid(box.bounds.maxs) && IsPlain(box.shader) &&
           std::ranges::all_of(box.faces, [](const SceneShader &shader) { return IsPlain(shader); });
}

/// Three points on a side, clockwise seen from outside.
std::string PointsText(std::size_t side, float at) {
    std::array<Vec3f, 3> points;
    const std::size_t axis = side / 2, u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    points[1][u] = points[2][v] = 64; // any size: the points define the plane
    if ((side % 2 != 0) != (axis == 1))
        std::swap(points[1], points[2]);
    std::string text;
    for (Vec3f &p : points) {
        p[axis] = at;
        text += fmt::format("( {} {} {} ) ", p.x, p.y, p.z);
    }
    return text;
}

std::string BrushText(const Box &box) {
    std::string text = "{\n";
    for (std::size_t side = 0; side < 6; side++) {
        const float at = (side % 2 != 0 ? box.bounds.maxs : box.bounds.mins)[side / 2];
        text += fmt::format("{}{} 0 0 0 0.5 0.5 {} 0 0\n", PointsText(side, at),
                            box.faces[side].name.substr(kFolder.size()), box.kind == BoxKind::Detail ? kDetailFlag : 0);
    }
    return text + "}\n";
}

std::string EntityText(const Entity &entity, std::span<const Box> brushes) {
    std::string text = "{\n";
    for (const auto &[key, value] : entity.pairs)
        text += fmt::format("\"{}\" \"{}\"\n", key, value);
    for (const Box &box : brushes)
        text += BrushText(box);
    return text + "}\n";
}

/// The interior, cut into cells by the sides of structural boxes.
class Cells {
  public:
    Cells(const Boundsf &interior, std::span<const Box> boxes) {
        for (std::size_t axis = 0; axis < 3; axis++) {
            std::vector<float> &cuts = cuts_[axis];
            cuts = {interior.mins[axis], interior.maxs[axis]};
            for (const Box &box : boxes)
                for (const float at : {box.bounds.mins[axis], box.bounds.maxs[axis]})
                    if (box.kind == BoxKind::Structural && at > interior.mins[axis] && at < interior.maxs[axis])
                        cuts.push_back(at);
            std::ranges::sort(cuts);
            cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
        }
        closed_.resize(Size(0) * Size(1) * Size(2));
        for (std::size_t i = 0; i < closed_.size(); i++)
            closed_[i] = std::ranges::any_of(boxes, [&](const Box &box) {
                return box.kind == BoxKind::Structural && box.bounds.Contains(MiddleOf(i));
            });
    }
    /// One point in each connected open space.
    std::vector<Vec3f> Places() {
        std::vector<Vec3f> places;
        for (std::size_t i = 0; i < closed_.size(); i++)
            if (!closed_[i]) {
                places.push_back(MiddleOf(i));
                Close(i);
            }
        return places;
    }

  private:
    std::size_t Size(std::size_t axis) const { return cuts_[axis].size() - 1; }
    std::array<std::size_t, 3> At(std::size_t cell) const {
        return {cell % Size(0), cell / Size(0) % Size(1), cell / Size(0) / Size(1)};
    }
    Vec3f MiddleOf(std::size_t cell) const {
        Vec3f p;
        for (std::size_t axis = 0; axis < 3; axis++)
            p[axis] = (cuts_[axis][At(cell)[axis]] + cuts_[axis][At(cell)[axis] + 1]) / 2;
        return p;
    }
    /// Closes the cell and all open cells connected to it.
    void Close(std::size_t cell) {
        std::vector<std::size_t> pending{cell};
        while (!pending.empty()) {
            const std::size_t at = pending.back();
            pending.pop_back();
            if (closed_[at])
                continue;
            closed_[at] = 1;
            std::size_t step = 1;
            for (std::size_t axis = 0; axis < 3; step *= Size(axis), axis++) {
                if (At(at)[axis] > 0)
                    pending.push_back(at - step);
                if (At(at)[axis] + 1 < Size(axis))
                    pending.push_back(at + step);
            }
        }
    }

    std::array<std::vector<float>, 3> cuts_;
    std::vector<char> closed_;
};

} // namespace

bool SceneBuilder::HasMapText() const {
    if (!surfaces_.empty() || visibility_.writeLump || walls_.empty())
        return false;
    for (const Entity &entity : entities_)
        if (const auto origin = entity.Vector({"origin"}); origin && !interior_.Contains(*origin))
            return false;
    for (const auto *boxes : {&walls_, &boxes_, &models_})
        if (!std::ranges::all_of(*boxes, [](const Box &box) { return IsPlain(box); }))
            return false;
    return true;
}

std::string SceneBuilder::MapText() const {
    if (!HasMapText())
        throw Error("scene: it has parts that no map source can have");
    std::vector<Box> brushes = walls_;
    brushes.insert(brushes.end(), boxes_.begin(), boxes_.end());
    std::string text = EntityText(world_, brushes);
    std::size_t model = 0;
    for (Entity entity : entities_) {
        const bool isModel = model < models_.size() && entity.Value("model") == fmt::format("*{}", model + 1);
        if (isModel)
            std::erase_if(entity.pairs, [](const auto &pair) { return pair.first == "model"; });
        text += EntityText(entity, isModel ? std::span(models_).subspan(model++, 1) : std::span<const Box>());
    }
    for (const Vec3f &p : Cells(interior_, boxes_).Places())
        text += EntityText({{{"classname", "info_null"}, {"origin", fmt::format("{} {} {}", p.x, p.y, p.z)}}}, {});
    return text;
}

} // namespace q3
