// GPL-2.0-or-later. Fuzz target json: the folder of JSON files that -json -pack reads, with one file from the input.
// What is packed is unpacked again and packs to the same map.
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/convert/json/convert_json.h"
#include "q3map2/convert/json/convert_json_bspx.h"
#include "q3map2/convert/json/convert_json_read.h"
#include "q3map2/shader/games.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/lumps_fixture.h"

namespace q3::fuzz {
namespace {

/// The folder of a map that has every lump.
class JsonFolder {
  public:
    JsonFolder() {
        Bsp bsp = test::MapWithoutLumps();
        // Small files keep the target fast: a page of lightmaps alone has 49152 numbers.
        bsp.lightmaps.clear();
        bsp.drawSurfaces[0].lightmapNum[0] = -3;
        for (std::size_t id = 0; id < kBspxIdCount; ++id)
            if (BspxId(id) != BspxId::LightmapsE5bgr9 && BspxId(id) != BspxId::Rnm)
                test::AddLump(bsp, BspxId(id), 5);
        bsp.bspx = {{"OTHER", std::vector<std::byte>(3, std::byte(1))}};
        bsp.advertisements.resize(1);
        SilentLog log;
        UnpackJson(bsp, *FindGame("quake3"), folder_.Path(), log);
        for (const auto &file : std::filesystem::directory_iterator(folder_.Path()))
            names_.push_back(file.path().filename().string());
        for (const std::string_view more : {kJsonEntityText, kJsonFormat})
            if (std::ranges::find(names_, more) == names_.end())
                names_.emplace_back(more);
        std::ranges::sort(names_);
    }
    std::size_t FileCount() const { return names_.size(); }
    const std::filesystem::path &Path() const { return folder_.Path(); }

    /// One file is another one as long as this exists.
    class Changed {
      public:
        Changed(const JsonFolder &folder, std::size_t file, std::string_view text)
            : path_(folder.Path() / folder.names_[file]), kept_(path_.string() + ".kept"),
              existed_(std::filesystem::exists(path_)) {
            if (existed_)
                std::filesystem::rename(path_, kept_);
            folder.folder_.Write(folder.names_[file], text);
        }
        ~Changed() {
            std::filesystem::remove(path_);
            if (existed_)
                std::filesystem::rename(kept_, path_);
        }
        Changed(const Changed &) = delete;
        Changed &operator=(const Changed &) = delete;
        const std::filesystem::path &Path() const { return path_; }

      private:
        std::filesystem::path path_, kept_;
        bool existed_;
    };

  private:
    ScratchFolder folder_;
    std::vector<std::string> names_; ///< sorted
};

BspFormat FormatOfPacked(const Bsp &bsp) {
    return {.version = bsp.ident == kIbspIdent ? 47 : 1, .advertisements = true, .ident = bsp.ident};
}

void PackAndUnpack(const std::filesystem::path &path, const PackJsonOptions &options, std::string_view gameName) {
    const Game &game = *FindGame(gameName);
    SilentLog log;
    Bsp bsp;
    if (!Accepts([&] { bsp = PackJson(path, game, options, log); }))
        return;
    ScratchFolder again;
    MustSucceed("an unpacked map", [&] {
        UnpackJson(bsp, game, again.Path(), log);
        const Bsp second = PackJson(again.Path(), game, {}, log);
        const BspFormat format = FormatOfPacked(bsp);
        Require(second.ident == bsp.ident && WriteBsp(second, format) == WriteBsp(bsp, format),
                "a map changes when it is unpacked and packed");
    });
}

} // namespace
} // namespace q3::fuzz

// Byte 0: the file. Byte 1: how it is read.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    static const JsonFolder folder; // made once: each input puts back what it changes
    Input input(data, size);
    const std::size_t file = input.Choose(folder.FileCount());
    const std::size_t how = input.Choose(3);
    const JsonFolder::Changed changed(folder, file, input.Text());
    Accepts([&] {
        q3::ReadJsonRecords(changed.Path(), "points", [](const q3::JsonRecord &record) {
            Require(!record.nodes.empty() && record.nodes[0].next == record.nodes.size(), "a record without its nodes");
            record.Label();
        });
    });
    PackAndUnpack(folder.Path(), {.useFlagNames = how > 0, .dropUnknownFlags = how == 2}, how == 1 ? "ja" : "quake3");
    return 0;
}
