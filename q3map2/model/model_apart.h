// GPL-2.0-or-later. Reads model files in a copy of the process: assimp crashes with some damaged files.
#pragma once

#include "common/files/vfs.h"
#include "q3map2/model/model_load.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace q3 {

/// The game's files, as a reader of models asks for them.
class ModelFiles {
  public:
    virtual ~ModelFiles() = default;
    virtual bool Exists(const std::string &name) const = 0;
    /// Nothing: there is no such file.
    virtual std::optional<std::vector<std::byte>> Read(const std::string &name) const = 0;
};

/// Calls `read` in a copy of the process and returns what it returns. The copy asks this process for files, so that the
/// VFS knows of them. On Windows, which has no copies, `read` runs here. Errors: those of `read`, as Error; `read`
/// crashes, does not end, or returns triangles of vertices that are not there.
Model ReadModelApart(const VirtualFileSystem &vfs, const std::function<Model(const ModelFiles &)> &read);

} // namespace q3
