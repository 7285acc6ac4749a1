#include "view/panel.h"

#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <functional>

#include "view/help.h"
#include "view/look.h"

namespace raymap::view {
namespace {

class Panel : public ::testing::Test {
 protected:
  Panel() {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
  }
  ~Panel() override { ImGui::DestroyContext(); }

  /// Shows panels until their sizes rest, without a device.
  static void show(const ImVec2& window, const std::function<void()>& panels) {
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    ImGui::GetIO().Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
    ImGui::GetIO().DisplaySize = window;
    for (int frame = 0; frame < 4; ++frame) {
      ImGui::NewFrame();
      panels();
      ImGui::EndFrame();
    }
  }
};

TEST_F(Panel, HelpFitsAnyWindow) {
  setLook({}, 1.0, 1.0);
  for (const ImVec2& window : {ImVec2(200, 150), ImVec2(640, 480), ImVec2(1280, 800), ImVec2(1920, 1080)}) {
    bool isShown = true;
    show(window, [&] { showHelp(isShown, panelWidth(window.x)); });
    const ImGuiWindow* help = ImGui::FindWindowByName("Mouse and keys###help");
    ASSERT_TRUE(help);
    EXPECT_GE(std::min(help->Pos.x, help->Pos.y), 0.0F);
    EXPECT_LE(help->Pos.x + help->Size.x, window.x);
    EXPECT_LE(help->Pos.y + help->Size.y, window.y);
    EXPECT_LE(help->ContentSize.x, help->WorkRect.GetWidth() + 1.0F);  // Lines wrap.
    const bool fits = help->ContentSize.y <= help->InnerRect.GetHeight();
    EXPECT_TRUE(fits || help->ScrollbarY);
    EXPECT_EQ(fits, window.x >= 640);
  }
}

TEST_F(Panel, TakesASmallerPartOfALargeWindow) {
  setLook({}, 1.0, 1.0);
  EXPECT_EQ(panelWidth(400), 0.0F);
  const float width = panelWidth(640);
  EXPECT_GT(width, 200.0F);
  EXPECT_LT(width, 400.0F);
  EXPECT_EQ(panelWidth(1920), width);
}

TEST_F(Panel, HasAFontWithoutItsFile) {
  setLook("no such font.ttf", 2.0, 1.0);
  EXPECT_EQ(fontHeight(), 28.0F);
  setLook({}, 2.0, 2.0);
  show({640, 480}, [] { EXPECT_EQ(ImGui::GetFontSize(), fontHeight()); });
}

TEST(ViewLegend, SaysWhereTheSurfaceIs) {
  RenderOptions view{.frame = Box{glm::dvec3(-1.0), glm::dvec3(1.0)}, .iso = 0.1};
  const Legend distance = legendOf(view, {});
  EXPECT_EQ(distance.levels, std::vector<double>{0.1});
  EXPECT_EQ(distance.sides, (std::vector<std::string>{"inside", "outside"}));
  EXPECT_EQ(distance.bar.least, -1.0);
  view.array = FieldArray::Winding;
  const Legend winding = legendOf(view, {});
  EXPECT_EQ(winding.levels, (std::vector<double>{-0.5, 0.5}));
  EXPECT_EQ(winding.sides, (std::vector<std::string>{"inside", "outside", "inside"}));
  view.array = FieldArray::Confidence;
  EXPECT_TRUE(legendOf(view, {}).levels.empty());
  const Legend difference = legendOf(view, 0.25);
  EXPECT_EQ(difference.levels, std::vector<double>{0.0});
  EXPECT_EQ(difference.bar.most, 0.25);
}

}  // namespace
}  // namespace raymap::view
