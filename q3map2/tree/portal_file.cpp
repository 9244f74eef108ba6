// GPL-2.0-or-later. The .prt file, input of the vis stage.
#include "q3map2/tree/portal_file.h"

#include "q3map2/tree/portals.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace q3 {

namespace {

class PortalFileWriter {
  public:
    explicit PortalFileWriter(const Tree &tree) : tree_(tree) {}
    std::string Text(int clusters);

  private:
    void AddLeaf(int leaf);
    void AddPortal(const TreePortal &portal);
    void AddSolidFace(const TreePortal &portal, int leaf);
    static void AppendPoints(std::string &text, const Polygon &polygon);

    const Tree &tree_;
    std::string portals_, faces_;
    int portalCount_ = 0, faceCount_ = 0;
};

void PortalFileWriter::AppendPoints(std::string &text, const Polygon &polygon) {
    for (const Vec3f &p : polygon) {
        text += '(';
        for (std::size_t axis = 0; axis < 3; axis++) {
            const double value = double(p[axis]), whole = std::rint(value);
            if (std::abs(value - whole) < 0.001)
                fmt::format_to(std::back_inserter(text), "{} ", static_cast<long long>(whole));
            else
                fmt::format_to(std::back_inserter(text), "{:f} ", value);
        }
        text += ") ";
    }
    text += '\n';
}

void PortalFileWriter::AddPortal(const TreePortal &portal) {
    // Readers compute the plane from the first three points. If these give a flipped plane, swaps the clusters.
    int front = tree_.nodes[std::size_t(portal.nodes[0])].cluster;
    int back = tree_.nodes[std::size_t(portal.nodes[1])].cluster;
    const Polygon &w = portal.polygon;
    const Vec3d normal = Normalize(Cross(Vec3d(w[2]) - Vec3d(w[0]), Vec3d(w[1]) - Vec3d(w[0])));
    if (Dot(portal.plane.normal, normal) < 0.99)
        std::swap(front, back);
    const int flags = (portal.compileFlags & C_HINT ? 1 : 0) | (portal.compileFlags & C_SKY ? 2 : 0);
    fmt::format_to(std::back_inserter(portals_), "{} {} {} {} ", w.size(), front, back, flags);
    AppendPoints(portals_, w);
    portalCount_++;
}

void PortalFileWriter::AddSolidFace(const TreePortal &portal, int leaf) {
    fmt::format_to(std::back_inserter(faces_), "{} {} ", portal.polygon.size(), tree_.nodes[std::size_t(leaf)].cluster);
    AppendPoints(faces_, portal.nodes[0] == leaf ? portal.polygon : Reversed(portal.polygon));
    faceCount_++;
}

void PortalFileWriter::AddLeaf(int leaf) {
    const TreeNode &node = tree_.nodes[std::size_t(leaf)];
    if (node.opaque)
        return;
    for (const int number : node.portals) {
        const TreePortal &portal = tree_.portals[std::size_t(number)];
        if (tree_.nodes[std::size_t(portal.nodes[0])].cluster == tree_.nodes[std::size_t(portal.nodes[1])].cluster)
            continue;
        if (!IsPassable(tree_, portal))
            AddSolidFace(portal, leaf);
        else if (portal.nodes[0] == leaf)
            AddPortal(portal);
    }
}

std::string PortalFileWriter::Text(int clusters) {
    std::vector<int> pending{tree_.head};
    while (!pending.empty()) {
        const int at = pending.back();
        pending.pop_back();
        const TreeNode &node = tree_.nodes[std::size_t(at)];
        if (node.IsLeaf()) {
            AddLeaf(at);
            continue;
        }
        pending.push_back(node.children[1]);
        pending.push_back(node.children[0]);
    }
    return fmt::format("PRT1\n{}\n{}\n{}\n", clusters, portalCount_, faceCount_) + portals_ + faces_;
}

} // namespace

std::string PortalFileText(const Tree &tree, int clusters) {
    return PortalFileWriter(tree).Text(clusters);
}

} // namespace q3
