// GPL-2.0-or-later. What goes into a package, what is missing, and the options of -pk3 and -repack.
#include "q3map2/pk3/package_plan.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

namespace q3 {

// ---- Options of -pk3 and -repack ----

namespace {

constexpr int kLeastLevel = -1, kMostLevel = 10; ///< of -complevel; zlib has -1 to 9

template <typename Options> SettingGroup<Options> PackingGroup() {
    return {"Packing",
            "",
            {{{.name = "-dbg",
               .help = "Prints what was collected: shaders, sounds, models, scripts and images",
               .since = "q3map2"},
              &Options::list},
             {{.name = "-png",
               .help = "Takes images in PNG too, before TGA and JPEG",
               .details = "Without this option PNG images are left out. The engine of Quake III Arena does not read "
                          "them, but many "
                          "later ones do.",
               .since = "q3map2"},
              &Options::png},
             {{.name = "-complevel",
               .values = "N",
               .range = {kLeastLevel, kMostLevel},
               .help = "Sets the compression: 0 none, 1 fast, 9 small, -1 as zlib chooses",
               .details = "The level 10 means the same as 9.",
               .since = "q3map2",
               .example = "6"},
              &Options::level},
             {{.name = "-outdir",
               .values = "DIR",
               .initial = "first base path",
               .help = "Names the folder in which the package is written",
               .since = "0.2.0",
               .example = "/home/mapper/release"},
              &Options::folder},
             {{.name = "-basepak",
               .values = "MASK",
               .initial = "none",
               .help = "Leaves out what archives of that name hold, which may contain ? and *",
               .details = "It is for archives that every player has. It may be given several times.",
               .since = "0.2.0",
               .example = "'pak?.pk3'"},
              &Options::basePaks},
             {{.name = "-exclude",
               .values = "FILE",
               .initial = "GAME.exclude next to the program",
               .help = "Names a file that lists what is left out, in addition to the default one",
               .details = "It may be given several times. The page [Releasing a "
                          "map](../guide/releasing.md#leaving-files-out) describes the file.",
               .since = "0.2.0",
               .example = "mymap.exclude"},
              &Options::exclusions}}};
}

} // namespace

std::vector<SettingGroup<PackOptions>> PackSettings() {
    return {PackingGroup<PackOptions>()};
}

std::vector<SettingGroup<RepackOptions>> RepackSettings() {
    SettingGroup<RepackOptions> group = PackingGroup<RepackOptions>();
    group.settings.push_back(
        {{.name = "-analyze", .help = "Prints what was collected, and writes nothing", .since = "q3map2"},
         &RepackOptions::onlyList});
    return {group};
}

// ---- The files of a package, and those that are missing ----

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 3> kSoundExtensions = {".wav", ".ogg", ".opus"};
constexpr std::string_view kPng = ".png";
constexpr int kMostLods = 3; ///< levels of detail of a model, MD3_MAX_LODS of engines: x.md3, x_1.md3, x_2.md3

std::string CutExtension(std::string_view name) {
    return PathOf(name).replace_extension().generic_string();
}

class Planner {
  public:
    Planner(MapNeeds &needs, const PackageSource &source, const EngineScripts &scripts, const PlanRules &rules,
            Log &log)
        : needs_(needs), source_(source), scripts_(scripts), rules_(rules), log_(log) {}

    PackagePlan Run() {
        PlanModels();
        FindRestrictedScripts();
        for (const Wanted &shader : needs_.shaders.All())
            PlanShader(shader);
        if (rules_.list)
            List();
        for (const Wanted &image : images_.All())
            PlanImage(image);
        for (const Wanted &image : plainImages_.All())
            if (!images_.Has(image.name))
                PlanImage(image);
        for (const Wanted &script : scriptFiles_.All())
            Take(script.name, script);
        for (const Wanted &sound : needs_.sounds.All())
            PlanSound(sound);
        for (const Wanted &video : videos_.All())
            if (!rules_.exclusions.HasVideo(video.name))
                TakeFirst(std::span(&video.name, 1), video, "");
        for (const std::string &model : models_)
            plan_.Add(model);
        return std::move(plan_);
    }

  private:
    void Report(const Wanted &wanted, std::string_view hint) {
        const std::string text = fmt::format("{}{}: wanted by {}", wanted.name, hint, wanted.why);
        (wanted.need == Need::Required ? plan_.missing : plan_.absent).push_back(text);
    }

    /// Adds the file unless it comes with the game; reports it if it does not exist.
    void Take(const std::string &name, const Wanted &wanted) {
        const Whereabouts where = source_.Find(name);
        if (where == Whereabouts::NotInBase)
            plan_.Add(name);
        else if (where == Whereabouts::Nowhere)
            Report(wanted, "");
    }

    /// Takes the first file that exists; reports `wanted`, with the hint, if none does.
    void TakeFirst(std::span<const std::string> names, const Wanted &wanted, std::string_view hint) {
        for (const std::string &name : names)
            if (source_.Find(name) != Whereabouts::Nowhere)
                return Take(name, wanted);
        Report(wanted, hint);
    }

    /// File names of an image in order of preference: with -png the .png comes first, otherwise it is left out.
    std::vector<std::string> ImageFiles(const std::string &image) const {
        std::vector<std::string> names;
        for (std::string &name : ImageFileNames(image, rules_.imageFiles)) {
            const bool isPng = name.ends_with(kPng);
            if (!isPng || rules_.png)
                names.insert(isPng ? names.begin() : names.end(), std::move(name));
        }
        return names;
    }

    void PlanImage(const Wanted &image) {
        if (rules_.exclusions.HasTexture(image.name))
            return;
        const std::vector<std::string> names = ImageFiles(image.name);
        std::string hint = " (";
        for (std::size_t i = 0; i < names.size(); ++i)
            hint += std::string(i == 0                 ? ""
                                : i + 1 < names.size() ? ", "
                                                       : " or ") +
                    (names[i].starts_with(image.name) ? names[i].substr(image.name.size()) : names[i]);
        const bool isPngOnly = !rules_.png && source_.Find(image.name + std::string(kPng)) != Whereabouts::Nowhere;
        TakeFirst(names, image, hint + (isPngOnly ? "; there is a .png, which -png packs)" : ")"));
    }

    /// Engines try other formats if the named file does not exist.
    void PlanSound(const Wanted &sound) {
        if (rules_.exclusions.HasSound(sound.name))
            return;
        std::vector<std::string> names{sound.name};
        for (const std::string_view extension : kSoundExtensions)
            if (!EndsWithNoCase(sound.name, extension))
                names.push_back(CutExtension(sound.name) + std::string(extension));
        TakeFirst(names, sound, "");
    }

    void PlanModels();
    void PlanModel(const std::string &name, const std::string &why);
    void FindRestrictedScripts();
    void PlanShader(const Wanted &wanted);
    const EngineShader &BestOf(std::span<const EngineShader> definitions) const;
    void PlanDefined(const EngineShader &shader, const Wanted &wanted);
    void List() const;

    MapNeeds &needs_;
    const PackageSource &source_;
    const EngineScripts &scripts_;
    const PlanRules &rules_;
    Log &log_;
    PackagePlan plan_;
    std::vector<std::string> restrictions_; ///< by script: why it must not be packed; empty: it may be
    WantedList images_;                     ///< of shaders that scripts define
    WantedList plainImages_; ///< with the name of a shader that no script defines, or that names no image
    WantedList scriptFiles_, videos_;
    std::vector<std::string> models_; ///< files of models and skins
};

/// Plans a model file that exists, and adds the shaders that it names.
void Planner::PlanModel(const std::string &name, const std::string &why) {
    if (source_.Find(name) == Whereabouts::NotInBase)
        models_.push_back(name);
    const auto bytes = source_.Read(name);
    if (!bytes)
        return;
    std::vector<std::string> shaders;
    if (EndsWithNoCase(name, ".md3"))
        shaders = ShadersOfMd3(*bytes);
    else if (EndsWithNoCase(name, ".skin"))
        shaders = ShadersOfSkin(AsText(*bytes));
    else
        log_.Warn("model format", "{}: shaders of this format are not known: see that they are in the package", name);
    for (const std::string &shader : shaders)
        needs_.shaders.Add(ImageName(shader), fmt::format("{} ({})", name, why));
}

void Planner::PlanModels() {
    for (const Wanted &model : needs_.models.All()) {
        if (source_.Find(model.name) == Whereabouts::Nowhere) {
            Report(model, "");
            continue;
        }
        PlanModel(model.name, model.why);
        for (int lod = 1; lod < kMostLods && EndsWithNoCase(model.name, ".md3"); ++lod)
            if (const std::string name = fmt::format("{}_{}.md3", CutExtension(model.name), lod);
                source_.Find(name) != Whereabouts::Nowhere)
                PlanModel(name, model.why);
    }
}

/// With rules_.wholeScripts a script must not be packed if it is excluded or defines an excluded shader: the game has
/// its own version.
void Planner::FindRestrictedScripts() {
    const Exclusions &exclusions = rules_.exclusions;
    for (const EngineScripts::Script &script : scripts_.Scripts()) {
        std::string why = exclusions.HasShaderFile(script.name) ? "it is excluded" : "";
        for (const std::string &shader : script.shaders)
            if (why.empty() && (exclusions.HasShader(shader) || exclusions.IsPureTexture(shader)))
                why = fmt::format("it also defines {}, which is excluded", shader);
        restrictions_.push_back(rules_.wholeScripts ? std::move(why) : std::string());
    }
}

/// The first definition whose images all exist, else the first one.
const EngineShader &Planner::BestOf(std::span<const EngineShader> definitions) const {
    const auto isComplete = [&](const EngineShader &shader) {
        return std::ranges::all_of(shader.images, [&](const std::string &image) {
            const auto names = ImageFiles(image);
            return rules_.exclusions.HasTexture(image) || std::ranges::any_of(names, [&](const std::string &name) {
                       return source_.Find(name) != Whereabouts::Nowhere;
                   });
        });
    };
    const auto found = std::ranges::find_if(definitions, isComplete);
    return found == definitions.end() ? definitions.front() : *found;
}

void Planner::PlanShader(const Wanted &wanted) {
    const std::string &name = wanted.name;
    if (name.starts_with('*') || name.starts_with('$') || EqualNoCase(name, "noshader"))
        return;
    if (rules_.exclusions.HasShader(name) || rules_.exclusions.IsPureTexture(name))
        return;
    if (const auto definitions = scripts_.Find(name); !definitions.empty())
        PlanDefined(BestOf(definitions), wanted);
    else
        plainImages_.Add(ImageName(name), wanted.why, wanted.need);
}

void Planner::PlanDefined(const EngineShader &shader, const Wanted &wanted) {
    const EngineScripts::Script &script = scripts_.Scripts()[shader.script];
    const bool isInBase = source_.Find(script.name) == Whereabouts::InBase;
    if (!restrictions_[shader.script].empty() && !isInBase) {
        plan_.missing.push_back(fmt::format("{}: wanted by {}; its script {} cannot be packed: {}", shader.name,
                                            wanted.why, script.name, restrictions_[shader.script]));
        return;
    }
    const std::string why = fmt::format("shader {}", shader.name);
    if (!shader.HasImages() && !shader.drawsWithoutImage) {
        log_.Warn("shader without images", "{}: visible shader {} names no image", script.name, shader.name);
        plainImages_.Add(ImageName(shader.name), why, Need::Optional);
    }
    for (const std::string &image : shader.images)
        images_.Add(image, why, wanted.need);
    for (const std::string &image : shader.extraImages)
        images_.Add(image, why, Need::Optional);
    for (const std::string &video : shader.videos)
        videos_.Add(video, why, wanted.need);
    if (isInBase)
        return;
    if (rules_.wholeScripts)
        scriptFiles_.Add(script.name, why);
    else
        plan_.strippedShaders.push_back(&shader);
}

void Planner::List() const {
    const auto print = [&](std::string_view title, const WantedList &list) {
        log_.Print("{} {}:\n", list.All().size(), title);
        for (const Wanted &wanted : list.All())
            log_.Print("  {} ({})\n", wanted.name, wanted.why);
    };
    print("shaders", needs_.shaders);
    print("images of shaders", images_);
    print("images without a shader", plainImages_);
    print("scripts", scriptFiles_);
    print("sounds", needs_.sounds);
    print("videos", videos_);
    print("models", needs_.models);
}

/// Whether a file in the map's folder is light that engines load: images lm_NNNN or lm_NNNN_*, HDR light of vertices,
/// the description of directional lightmaps, and light of static props (proplight.raw, and sp_N.vhv by prop).
bool IsLightFile(const fs::path &file) {
    const std::string name = LowerCase(file.filename().string());
    if (name == "vertlight.raw" || name == "lightmass.json" || name == "proplight.raw")
        return true;
    constexpr std::array<std::string_view, 4> kImages = {".tga", ".jpg", ".png", ".hdr"};
    const std::string stem = fs::path(name).stem().string(), extension = fs::path(name).extension().string();
    if (stem.starts_with("sp_") && extension == ".vhv")
        return StrictInteger(stem.substr(3)).has_value();
    return stem.starts_with("lm_") && StrictInteger(stem.substr(3, stem.find('_', 3) - 3)).has_value() &&
           std::ranges::find(kImages, extension) != kImages.end();
}

} // namespace

void PackagePlan::Add(std::string_view name, fs::path disk) {
    if (names_.Add(name, ""))
        files_.push_back({NameInPackage(name), std::move(disk)});
}

PackagePlan MakePlan(MapNeeds &needs, const PackageSource &source, const EngineScripts &scripts, const PlanRules &rules,
                     Log &log) {
    return Planner(needs, source, scripts, rules, log).Run();
}

void AddLightFiles(const fs::path &bspPath, const WantedList &externalPages, const PackageSource &source,
                   PackagePlan &plan) {
    const std::string name = bspPath.stem().string();
    std::vector<fs::path> pages;
    for (fs::path &entry : EntriesOf(bspPath.parent_path() / name))
        if (IsLightFile(entry))
            pages.push_back(std::move(entry));
    std::ranges::sort(pages);
    for (const fs::path &page : pages)
        plan.Add(fmt::format("maps/{}/{}", name, page.filename().string()), page);
    for (const Wanted &page : externalPages.All()) {
        const auto stem = fs::path(page.name).stem();
        const bool isBeside =
            std::ranges::any_of(pages, [&](const fs::path &p) { return p.stem() == stem && p.extension() != ".hdr"; });
        if (isBeside || !StartsWithNoCase(page.name, fmt::format("maps/{}/", name)))
            continue;
        if (source.Find(page.name) == Whereabouts::NotInBase)
            plan.Add(page.name);
        else if (source.Find(page.name) == Whereabouts::Nowhere)
            plan.missing.push_back(fmt::format("{}: wanted by {}", page.name, page.why));
    }
}

void AddMapFiles(const fs::path &bspPath, const WantedList &externalPages, const PackageSource &source,
                 PackagePlan &plan) {
    AddLightFiles(bspPath, externalPages, source, plan);
    const std::string name = bspPath.stem().string();
    plan.Add(fmt::format("maps/{}.bsp", name), bspPath);
    const auto addIfThere = [&](const std::string &entry, const fs::path &beside, std::string_view use) {
        if (fs::is_regular_file(beside))
            plan.Add(entry, beside);
        else if (source.Find(entry) == Whereabouts::NotInBase)
            plan.Add(entry);
        else if (!use.empty())
            plan.absent.push_back(fmt::format("{}: {}", entry, use));
    };
    for (const std::string_view end : {".aas", "_b0.aas", "_b1.aas"})
        addIfThere(fmt::format("maps/{}{}", name, end), bspPath.parent_path() / (name + std::string(end)),
                   end == ".aas" ? "bots will not play the map" : "");
    addIfThere(fmt::format("scripts/{}.arena", name), {}, "the menus of the game will not list the map");
    addIfThere(fmt::format("scripts/{}.defi", name), {}, "");
}

void WritePackage(const fs::path &path, const fs::path &failedPath, int level, const PackageSource &source,
                  PackagePlan &plan, FileSet &files, Log &log) {
    ArchiveWriter archive(level);
    int count = 0;
    for (const PackageEntry &entry : plan.Files()) {
        const auto bytes = entry.disk.empty() ? source.Read(entry.name) : std::optional(ReadFile(entry.disk));
        if (!bytes) {
            plan.missing.push_back(fmt::format("{}: it is damaged", entry.name));
            continue;
        }
        archive.Add(entry.name, *bytes);
        ++count;
        log.Print("++{}\n", entry.name);
    }
    const fs::path &target = plan.missing.empty() ? path : failedPath;
    log.Print("Writing {}\n", target.string());
    const std::vector<std::byte> bytes = archive.Finish();
    files.AddFile(target, bytes);
    if (const fs::path &other = plan.missing.empty() ? failedPath : path; other != target)
        files.AddRemoval(other);
    files.AddLine(log, fmt::format("Wrote {}, {} ({})\n", Counted(count, "files"), SizeText(bytes.size()),
                                   Counted(bytes.size(), "bytes")));
    files.Commit();
}

} // namespace q3
