#include "viewer/window/key_bindings.h"

#include <gtest/gtest.h>

#include <set>
#include <string_view>
#include <tuple>

namespace strata {
namespace {

constexpr int kControl = 2;  // GLFW_MOD_CONTROL

InputEvent key(int code, bool down, int modifiers = 0) {
  return {.kind = InputEvent::Kind::key, .code = code, .down = down, .modifiers = modifiers};
}

TEST(KeyBindings, EveryCommandHasOneRowAndAnExplanation) {
  std::set<Command> commands;
  for (const KeyBinding& binding : keyBindings()) {
    EXPECT_TRUE(commands.insert(binding.command).second) << binding.keyName;
    EXPECT_GT(binding.keys[0], 0) << binding.keyName;
    EXPECT_FALSE(std::string_view(binding.explanation).empty()) << binding.keyName;
  }
  EXPECT_EQ(commands.size(), static_cast<std::size_t>(Command::count));
}

TEST(KeyBindings, NoKeyHasTwoCommandsAndNoneFliesToo) {
  std::set<std::tuple<int, bool>> keys;
  for (const int flying : {'W', 'A', 'S', 'D', 'E', 'Q'}) keys.insert({flying, false});
  for (const KeyBinding& binding : keyBindings())
    for (const int code : binding.keys)
      EXPECT_TRUE(code == 0 || keys.insert({code, binding.control}).second) << binding.keyName;
}

TEST(KeyboardState, ACommandIsGivenOnceInTheFrameInWhichItsKeyGoesDown) {
  KeyboardState keyboard;
  EXPECT_TRUE(keyboard.commands().none());
  keyboard.take(key('F', true));
  EXPECT_TRUE(keyboard.commands().has(Command::showAll));
  EXPECT_FALSE(keyboard.commands().has(Command::saveProject));
  keyboard.beginFrame();
  EXPECT_TRUE(keyboard.commands().none());
  InputEvent repeated = key('F', true);
  repeated.repeated = true;
  keyboard.take(repeated);
  EXPECT_TRUE(keyboard.commands().none());
}

TEST(KeyboardState, ControlMakesAnotherCommandOfAKey) {
  KeyboardState keyboard;
  keyboard.take(key('P', true, kControl));
  EXPECT_TRUE(keyboard.commands().has(Command::takePicture));
  EXPECT_FALSE(keyboard.commands().has(Command::toggleOutputPanel));
}

TEST(KeyboardState, AShortcutDoesNotFlyThoughItsLetterIsHeldLongerThanControl) {
  KeyboardState keyboard;
  keyboard.take(key('S', true, kControl));
  EXPECT_TRUE(keyboard.flying(false).still());
  keyboard.take(key('S', false));
  keyboard.take(key('W', true));
  EXPECT_EQ(keyboard.flying(false).forward, 1);
  keyboard.beginFrame();
  EXPECT_EQ(keyboard.flying(false).forward, 1);
  keyboard.take(key('W', false));
  EXPECT_TRUE(keyboard.flying(false).still());
}

TEST(KeyboardState, AKeyWithoutACodeIsLeftAlone) {
  KeyboardState keyboard;
  keyboard.take(key(-1, true));
  EXPECT_TRUE(keyboard.commands().none());
  EXPECT_TRUE(keyboard.flying(false).still());
}

}  // namespace
}  // namespace strata
