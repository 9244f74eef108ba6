// GPL-2.0-or-later. Reads model files in a copy of the process: assimp crashes with some damaged files.
#include "q3map2/model/model_apart.h"

#include "common/error.h"
#include "common/platform/process_copy.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <span>
#include <utility>

namespace q3 {

namespace {

/// Limits of this program, chosen. The largest models of games take less than a second and 100 MB.
constexpr CopyLimits kModelLimits{.moreBytes = std::uint64_t(4) << 30, .cpuSeconds = 60};

class VfsModelFiles final : public ModelFiles {
  public:
    explicit VfsModelFiles(const VirtualFileSystem &vfs) : vfs_(vfs) {}
    bool Exists(const std::string &name) const override { return vfs_.Exists(name); }
    std::optional<std::vector<std::byte>> Read(const std::string &name) const override { return vfs_.Read(name); }

  private:
    const VirtualFileSystem &vfs_;
};

// ---- Messages between the copy and the process ----

/// From the copy. The first two name a file; the answer to Exists is a byte, to Read a byte and the file.
enum class ModelMessage : std::uint8_t { Exists, Read, Done, Failed };

std::vector<std::byte> BytesOf(const Model &model) {
    UnitWriter writer;
    writer.Put(ModelMessage::Done);
    writer.Put(std::uint64_t(model.meshes.size()));
    for (const ModelMesh &mesh : model.meshes) {
        writer.PutText(mesh.shader);
        writer.PutAll(mesh.verts);
        writer.PutAll(mesh.triangles);
    }
    return writer.Take();
}

/// What follows ModelMessage::Done. The copy may have damaged itself, so nothing is taken for granted.
Model ModelFrom(UnitReader &reader) {
    Model model;
    std::uint64_t meshes = 0;
    reader.Get(meshes);
    for (std::uint64_t i = 0; i < meshes && reader.Fits(); ++i) {
        ModelMesh &mesh = model.meshes.emplace_back();
        reader.GetText(mesh.shader);
        reader.GetAll(mesh.verts);
        reader.GetAll(mesh.triangles);
        for (const auto &triangle : mesh.triangles)
            for (const int corner : triangle)
                if (corner < 0 || std::size_t(corner) >= mesh.verts.size())
                    throw Error("a triangle names vertex {} of {}", corner, mesh.verts.size());
    }
    if (!reader.IsComplete())
        throw Error("the model reader (assimp) is damaged by this file");
    return model;
}

/// In the copy: the files that the process has.
class AskedModelFiles final : public ModelFiles {
  public:
    explicit AskedModelFiles(Channel &channel) : channel_(channel) {}
    bool Exists(const std::string &name) const override { return Ask(ModelMessage::Exists, name).has_value(); }
    std::optional<std::vector<std::byte>> Read(const std::string &name) const override {
        return Ask(ModelMessage::Read, name);
    }

  private:
    std::optional<std::vector<std::byte>> Ask(ModelMessage what, const std::string &name) const {
        UnitWriter writer;
        writer.Put(what);
        writer.PutText(name);
        channel_.Send(writer.Take());
        auto answer = channel_.Receive();
        if (!answer || answer->empty() || answer->front() == std::byte(0))
            return std::nullopt;
        answer->erase(answer->begin());
        return answer;
    }

    Channel &channel_;
};

std::vector<std::byte> Failure(std::string_view why) {
    UnitWriter writer;
    writer.Put(ModelMessage::Failed);
    writer.PutText(why);
    return writer.Take();
}

/// The whole work of the copy.
void AnswerWithModel(Channel &channel, const std::function<Model(const ModelFiles &)> &read) {
    std::vector<std::byte> answer;
    try {
        answer = BytesOf(read(AskedModelFiles(channel)));
    } catch (const std::bad_alloc &) {
        answer = Failure("it needs too much memory");
    } catch (const std::exception &error) {
        answer = Failure(error.what());
    }
    channel.Send(answer);
}

/// In the process: the answer to ModelMessage::Exists or Read.
std::vector<std::byte> AnswerWithFile(const ModelFiles &files, ModelMessage what, const std::string &name) {
    const bool exists = files.Exists(name);
    std::vector<std::byte> answer{std::byte(exists ? 1 : 0)};
    if (what == ModelMessage::Exists || !exists)
        return answer;
    const auto file = files.Read(name);
    answer.front() = std::byte(file ? 1 : 0);
    if (file)
        answer.insert(answer.end(), file->begin(), file->end());
    return answer;
}

} // namespace

Model ReadModelApart(const VirtualFileSystem &vfs, const std::function<Model(const ModelFiles &)> &read) {
    const VfsModelFiles files(vfs);
    if (!ProcessCopy::IsAvailable())
        return read(files);
    ProcessCopy copy(kModelLimits, [&read](Channel &channel) { AnswerWithModel(channel, read); });
    for (;;) {
        const auto message = copy.ToCopy().Receive();
        if (!message)
            throw Error("the model reader (assimp) fails with this file: {}", copy.Wait());
        UnitReader reader(*message);
        ModelMessage what{};
        std::string text;
        reader.Get(what);
        if (what == ModelMessage::Done)
            return ModelFrom(reader);
        reader.GetText(text);
        if (what == ModelMessage::Failed)
            throw Error("{}", text);
        copy.ToCopy().Send(AnswerWithFile(files, what, text));
    }
}

} // namespace q3
