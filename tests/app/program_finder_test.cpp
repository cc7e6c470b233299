#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/base/file_stamp.h"
#include "app/library/find/folder_walk.h"
#include "app/library/find/program_finder.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

namespace fs = std::filesystem;
using test_support::ScopedFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string good = "G21 G90\nG0 X1.\nM30\n";

/// A folder in which programs are searched; names are relative to it.
class ProgramFinder : public testing::Test {
protected:
    void write(const std::string& name, const std::string& bytes = good) const {
        fs::create_directories(fs::path(folder / name).parent_path());
        folder.write(name, bytes);
    }

    /// The result of find_programs, without projects.
    struct Found {
        std::vector<std::string> programs;
        std::vector<SkippedFile> skipped;
        std::vector<core::Error> failures;

        /// Skipped files with the reason.
        std::vector<std::string> skips() const {
            std::vector<std::string> all;
            for (const SkippedFile& file : skipped) all.push_back(file.path + " " + file.why);
            return all;
        }
    };

    Found find(const std::vector<std::string>& names) const {
        std::vector<std::string> words;
        for (const std::string& name : names) words.push_back(folder / name);
        const FoundPrograms programs = find_programs(words);
        Found found{{}, programs.skipped, programs.failures};
        for (const FoundProgram& program : programs.programs)
            found.programs.push_back(short_name(program.path));
        for (SkippedFile& file : found.skipped) file.path = short_name(file.path);
        for (core::Error& error : found.failures) error.file = short_name(error.file);
        return found;
    }

    std::string short_name(const std::string& path) const {
        return path.substr(folder.path().string().size() + 1);
    }

    ScopedFolder folder;
};

TEST_F(ProgramFinder, SearchesAFolderWithAllBelowItInOrder) {
    for (const char* name :
         {"b.nc", "a.NC", "deep/er/c.ngc", "deep/d.tap", ".hidden/e.nc", ".f.nc"})
        write(name);
    const Found found = find({"."});
    EXPECT_THAT(found.programs, ElementsAre("a.NC", "b.nc", "deep/d.tap", "deep/er/c.ngc"));
    EXPECT_THAT(found.failures, IsEmpty());
}

TEST_F(ProgramFinder, NamesWhatItSkipsInAFolder) {
    write("a.nc");
    write("part.stl", std::string(84, '\0'));
    write("notes.txt", "Clamp it well.\nG0 is fast, they say, and so on.\nThe end.\n");
    write("empty.nc", "");
    write("image.nc", std::string("\x89PNG\0\0\0", 7));
    fs::create_symlink("nowhere", folder / "gone.nc");
    ASSERT_EQ(::mkfifo((folder / "pipe.nc").c_str(), 0600), 0);
    const Found found = find({"."});
    EXPECT_THAT(found.programs, ElementsAre("a.nc"));
    EXPECT_THAT(found.skips(), testing::UnorderedElementsAre(
                                   "part.stl is a mesh or a drawing",
                                   HasSubstr("notes.txt most of its lines"), "empty.nc is empty",
                                   HasSubstr("image.nc"), "gone.nc is a link that leads nowhere",
                                   "pipe.nc is neither a file nor a folder"));
}

TEST_F(ProgramFinder, TakesWhatIsNamedAsItIs) {
    write("notes.md", "# no program\n");
    EXPECT_THAT(find({"notes.md", "not there.nc"}).programs,
                ElementsAre("notes.md", "not there.nc"));
}

TEST_F(ProgramFinder, FailsWhereNothingIsFound) {
    fs::create_directory(folder / "empty");
    write("texts/notes.md", "# no program\n");
    const Found found = find({"empty", "texts", "*.tap"});
    EXPECT_THAT(found.programs, IsEmpty());
    ASSERT_EQ(found.failures.size(), 3U);
    EXPECT_EQ(found.failures[0].file + " " + found.failures[0].message,
              "empty contains no NC program");
    EXPECT_EQ(found.failures[1].file + " " + found.failures[1].message,
              "texts contains no NC program");
    EXPECT_EQ(found.failures[2].file + " " + found.failures[2].message, "*.tap matches no file");
}

TEST_F(ProgramFinder, EntersEachFolderOnceDespiteLinks) {
    write("a/one.nc");
    fs::create_directory_symlink("..", folder / "a/up");
    fs::create_directory_symlink(".", folder / "a/self");
    fs::create_directory_symlink("a", folder / "Link before its target");
    const Found found = find({"."});
    EXPECT_THAT(found.programs, ElementsAre("a/one.nc"));
    EXPECT_THAT(find({"**/*.nc"}).programs, ElementsAre("a/one.nc"));
}

TEST_F(ProgramFinder, EntersAFolderByTheFirstOfItsLinksInAnyOrderOfTheDisk) {
    const ScopedFolder other;
    other.write("far.nc", good);
    // File systems list names by hash, latest first, or in order: some of these differ.
    const std::vector<std::string> names = {"m", "c", "x", "a", "k", "z", "b"};
    for (const std::string& name : names) {
        fs::create_directory(folder / name);
        fs::create_directory_symlink(other.path(), folder / (name + "/link"));
    }
    EXPECT_THAT(find({"."}).programs, ElementsAre("a/link/far.nc"));
}

TEST_F(ProgramFinder, FollowsALinkOutOfTheFolder) {
    const ScopedFolder other;
    other.write("far.nc", good);
    write("near.nc");
    fs::create_directory_symlink(other.path(), folder / "link");
    fs::create_symlink(other / "far.nc", folder / "file link.nc");
    EXPECT_THAT(find({"."}).programs, ElementsAre("file link.nc", "link/far.nc", "near.nc"));
}

TEST_F(ProgramFinder, TakesAProgramOnceHoweverOftenItIsNamed) {
    write("a.nc");
    write("b.nc");
    EXPECT_THAT(find({"b.nc", ".", "./b.nc", "*.nc"}).programs, ElementsAre("b.nc", "a.nc"));
}

TEST_F(ProgramFinder, TakesAProgramOnceHoweverItsFolderIsSpelled) {
    write("u/a.nc");
    write("u/notes.md");
    write("v/b.nc");
    fs::create_directory_symlink("u", folder / "link");
    const Found found = find({"u", "u/../u", "link", "v/../u/*", "u/../v/b.nc", "v"});
    EXPECT_THAT(found.programs, ElementsAre("u/a.nc", "u/../v/b.nc"));
    EXPECT_THAT(found.skips(), ElementsAre("u/notes.md is a document"));
    EXPECT_THAT(found.failures, IsEmpty());
}

TEST_F(ProgramFinder, KeepsALinkInTheFolderOfItsProgram) {
    write("a.nc");
    fs::create_symlink("a.nc", folder / "b.nc");
    EXPECT_THAT(find({"."}).programs, ElementsAre("a.nc", "b.nc"));
}

/// Root can read everything, so root temporarily becomes the user nobody.
class Unprivileged {
public:
    explicit Unprivileged(const ScopedFolder& folder) : is_root_(::geteuid() == 0) {
        fs::permissions(folder.path(), fs::perms::all);
        if (is_root_ && ::seteuid(65534) != 0) ADD_FAILURE() << "cannot become nobody";
    }
    ~Unprivileged() {
        if (is_root_ && ::seteuid(0) != 0) ADD_FAILURE() << "cannot become root again";
    }
    Unprivileged(const Unprivileged&) = delete;
    Unprivileged& operator=(const Unprivileged&) = delete;

private:
    bool is_root_;
};

TEST_F(ProgramFinder, ReportsAFolderThatCannotBeRead) {
    write("a.nc");
    write("locked/b.nc");
    write("listed/c.nc");
    fs::permissions(folder / "locked", fs::perms::none);
    fs::permissions(folder / "listed", fs::perms(0444));
    for (const char* word : {".", "**/*.nc", "*/*.nc", "?????d/[bc].nc"}) {
        SCOPED_TRACE(word);
        Found found;
        {
            const Unprivileged nobody(folder);
            found = find({word, "a.nc"});
        }
        EXPECT_THAT(found.programs, ElementsAre("a.nc"));
        ASSERT_EQ(found.failures.size(), 2U);
        std::vector<std::string> texts;
        for (const core::Error& error : found.failures)
            texts.push_back(error.file + " " + error.message);
        EXPECT_THAT(texts, testing::UnorderedElementsAre(
                               HasSubstr("locked this folder cannot be read: Permission"),
                               HasSubstr("listed/c.nc cannot be accessed: Permission")));
    }
    fs::permissions(folder / "locked", fs::perms::owner_all);
    fs::permissions(folder / "listed", fs::perms::owner_all);
}

TEST_F(ProgramFinder, NamesWhatAPatternPassesOver) {
    write("ok/a.nc");
    fs::create_symlink("nowhere", folder / "ok/gone.nc");
    fs::create_symlink("not mounted", folder / "share");
    fs::create_symlink("loop", folder / "loop");
    ASSERT_EQ(::mkfifo((folder / "ok/pipe.nc").c_str(), 0600), 0);
    const std::vector<std::string> expected = {
        "loop is a link that leads nowhere", "ok/gone.nc is a link that leads nowhere",
        "ok/pipe.nc is neither a file nor a folder", "share is a link that leads nowhere"};
    for (const char* word : {"**/*.nc", "*/*.nc"}) {
        const Found found = find({word});
        EXPECT_THAT(found.programs, ElementsAre("ok/a.nc")) << word;
        EXPECT_THAT(found.skips(), testing::ElementsAreArray(expected)) << word;
        EXPECT_THAT(found.failures, IsEmpty()) << word;
    }
    EXPECT_THAT(find({"*/a.nc", "no*/a.nc"}).failures, testing::SizeIs(1));
}

TEST_F(ProgramFinder, ReadsNoPipeAndNoDevice) {
    write("a.nc");
    ASSERT_EQ(::mkfifo((folder / "pipe.nc").c_str(), 0600), 0);
    fs::create_symlink("/dev/zero", folder / "zeros.nc");
    const Found found = find({"a.nc", "pipe.nc", "zeros.nc", "*.nc"});
    EXPECT_THAT(found.programs, ElementsAre("a.nc"));
    ASSERT_EQ(found.failures.size(), 2U);
    EXPECT_THAT(found.failures[0].message, HasSubstr("pipe or a device"));
    EXPECT_EQ(found.failures[1].file, "zeros.nc");
}

TEST_F(ProgramFinder, TakesAFolderAsItIsCalledAndOnlyWordsForPatterns) {
    write("jobs[1]/a.nc");
    write("jobs[1]/deep/b.nc");
    write("jobs1/wrong.nc");
    for (const std::string word : {"**/*.nc", ".", "*"}) {
        const FoundPrograms found = find_programs({word}, folder / "jobs[1]");
        ASSERT_FALSE(found.programs.empty()) << word;
        EXPECT_EQ(short_name(found.programs[0].path), "jobs[1]/a.nc") << word;
        EXPECT_EQ(found.programs.size(), word == "*" ? 1U : 2U) << word;
    }
}

TEST_F(ProgramFinder, KnowsPatterns) {
    for (const char* name : {"a1.nc", "a2.nc", "b1.nc", ".a3.nc", "x/a4.nc", "x/y/a5.nc"})
        write(name);
    EXPECT_THAT(find({"a*.nc"}).programs, ElementsAre("a1.nc", "a2.nc"));
    EXPECT_THAT(find({"?1.nc"}).programs, ElementsAre("a1.nc", "b1.nc"));
    EXPECT_THAT(find({"[!a]*.nc"}).programs, ElementsAre("b1.nc"));
    EXPECT_THAT(find({"*/a?.nc"}).programs, ElementsAre("x/a4.nc"));
    EXPECT_THAT(find({"x/**/*.nc"}).programs, ElementsAre("x/a4.nc", "x/y/a5.nc"));
    EXPECT_THAT(find({"**/a[45].nc"}).programs, ElementsAre("x/a4.nc", "x/y/a5.nc"));
    EXPECT_THAT(find({"x/**"}).programs, ElementsAre("x/a4.nc", "x/y/a5.nc"));
    EXPECT_THAT(find({".a*"}).programs, ElementsAre(".a3.nc"));
}

TEST_F(ProgramFinder, TakesAFileBeforeAPatternOfTheSameName) {
    write("part[1].nc");
    write("part1.nc");
    EXPECT_THAT(find({"part[1].nc"}).programs, ElementsAre("part[1].nc"));
}

TEST_F(ProgramFinder, KnowsNamesWithBlanksAndOfAnyAlphabet) {
    for (const char* name : {"Gehäuse links.nc", "部品/図1.nc", "new\nline.nc"}) write(name);
    EXPECT_THAT(find({"."}).programs,
                ElementsAre("Gehäuse links.nc", "new\nline.nc", "部品/図1.nc"));
}

TEST(PlainPath, LeavesOutWhatLeadsNowhere) {
    EXPECT_EQ(plain_path("./a//./b.nc"), "a/b.nc");
    EXPECT_EQ(plain_path("/a/./b/"), "/a/b");
    EXPECT_EQ(plain_path("link/../b.nc"), "link/../b.nc");
    EXPECT_EQ(plain_path("."), ".");
}

TEST(FileKind, KnowsProgramsOfEveryDialect) {
    EXPECT_FALSE(why_no_program_text("%\nO1000\nN10 G21 G90\nN20 T1 M6\n(cut)\nX1 Y2\nM30\n%\n"));
    EXPECT_FALSE(why_no_program_text("0 BEGIN PGM PLATE MM\n1 L X+10 FMAX\n2 END PGM PLATE MM\n"));
    EXPECT_FALSE(why_no_program_text("; header\nN10 G17 G90\nR1=5\nN20 G1 X=R1 F100\nM30\n"));
    EXPECT_FALSE(why_no_program_text("#<depth>=5\no<cut> sub\nG1 Z-5 F100\no<cut> endsub\nM2\n"));
}

TEST(FileKind, RecognisesTextsThatAreNotPrograms) {
    EXPECT_TRUE(why_no_program_text("#include <stdio.h>\nint main(void) {\n    return 0;\n}\n"));
    EXPECT_TRUE(why_no_program_text("Dear customer,\nyour G0 and M30 are fine.\nYours\n"));
    EXPECT_TRUE(why_no_program_text("solid part\nfacet normal 0 0 1\nouter loop\n"));
    EXPECT_TRUE(why_no_program_text(""));
}

} // namespace
} // namespace app
