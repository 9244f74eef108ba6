// GPL-2.0-or-later. Models of static props, prepared for lighting at vertices.
#include "q3map2/light/props/prop_model.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/prop_light.h"
#include "q3map2/model/md3_model.h"

#include <algorithm>
#include <tuple>

namespace q3 {

namespace {

using WeldKey = std::tuple<float, float, float, float, float, float>;

WeldKey WeldKeyOf(const DrawVert &v) {
    const auto plain = [](float x) { return x + 0.0f; }; // turns -0 into 0
    return {plain(v.xyz.x), plain(v.xyz.y), plain(v.xyz.z), plain(v.normal.x), plain(v.normal.y), plain(v.normal.z)};
}

} // namespace

PropModel::PropModel(Model model) : meshes(std::move(model.meshes)) {
    std::map<WeldKey, std::uint32_t> welded;
    std::vector<std::uint32_t> cornerPoints;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        std::vector<std::uint32_t> &numbers = pointOf.emplace_back();
        for (const DrawVert &vert : meshes[m].verts) {
            const auto [at, added] = welded.try_emplace(WeldKeyOf(vert), std::uint32_t(points.size()));
            if (added)
                points.push_back({vert.xyz, vert.normal, std::uint32_t(m)});
            numbers.push_back(at->second);
            bounds.Add(vert.xyz);
        }
        for (const auto &triangle : meshes[m].triangles)
            for (const int corner : triangle) {
                corners.push_back(meshes[m].verts[std::size_t(corner)].xyz);
                cornerPoints.push_back(numbers[std::size_t(corner)]);
            }
    }
    firstCorner.resize(points.size() + 1);
    for (const std::uint32_t point : cornerPoints)
        ++firstCorner[point + 1];
    for (std::size_t i = 1; i < firstCorner.size(); ++i)
        firstCorner[i] += firstCorner[i - 1];
    cornersAt.resize(cornerPoints.size());
    std::vector<std::uint32_t> next = firstCorner;
    for (std::size_t c = 0; c < cornerPoints.size(); ++c)
        cornersAt[next[cornerPoints[c]]++] = std::uint32_t(c);
}

std::unique_ptr<PropModel> PropModels::Read(const std::string &name, int frame) {
    const auto bytes = vfs_ == nullptr ? std::nullopt : vfs_->Read(name);
    if (!bytes)
        throw Error("there is no such file");
    std::unique_ptr<PropModel> model;
    if (IsMd3(*bytes)) {
        model = std::make_unique<PropModel>(ReadMd3(*bytes, name, frame));
    } else {
        std::string problem;
        const Model *read = library_.Get(name, frame, problem);
        if (read == nullptr)
            throw Error("{}", problem);
        model = std::make_unique<PropModel>(*read);
    }
    model->crc = Crc32(*bytes);
    return model;
}

const PropModel *PropModels::Get(std::string_view name, int frame, std::string &problem) {
    std::string path(name);
    std::replace(path.begin(), path.end(), '\\', '/');
    const auto [at, added] = entries_.try_emplace({LowerCase(path), frame});
    Entry &entry = at->second;
    if (added) {
        try {
            entry.model = Read(path, frame);
        } catch (const std::exception &error) {
            entry.problem = error.what();
        }
    }
    problem = entry.problem;
    return entry.model.get();
}

} // namespace q3
