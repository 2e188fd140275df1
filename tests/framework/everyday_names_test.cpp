// SPDX-License-Identifier: Zlib
// A user's everyday names together with all names of lpc. A name of lpc that does not suggest collision or physics
// would be ambiguous here when used; it then needs a longer name (WorkCount, AlgorithmInfo).
#include <gtest/gtest.h>

#include "framework/draw/draw_simulation.h"
#include "framework/draw/draw_structure.h"
#include "framework/scene/director.h"
#include "framework/scene/recording.h"
#include "framework/stage/plugin.h"
#include "framework/world/invariants.h"
#include "framework/world/pose_penetration.h"
#include "framework/world/stage_engine.h"
#include "framework/world/world.h"

// Names common in games, tools and exercises.
// clang-format off
#define EVERYDAY_TYPES(X)                                                                                             \
  X(Action) X(Actor) X(Address) X(Agent) X(Angle) X(Animation) X(Application) X(Argument) X(Array) X(Asset) X(Batch)  \
  X(Block) X(Buffer) X(Button) X(Camera) X(Cell) X(Chart) X(Client) X(Clock) X(Color) X(Colour) X(Command)            \
  X(Component) X(Config) X(Context) X(Controller) X(Count) X(Counter) X(Data) X(Detect) X(Device) X(Dimension)        \
  X(Direction) X(Duration) X(Edge) X(Entity) X(Entry) X(Error) X(Event) X(Experiment) X(Face) X(Field) X(File)        \
  X(Flags) X(Frame) X(Function) X(Game) X(Graph) X(Grid) X(Group) X(Id) X(Image) X(Index) X(Info) X(Input)            \
  X(Interval) X(Item) X(Iterator) X(Job) X(Key) X(Kind) X(Label) X(Layer) X(Level) X(Limits) X(Line) X(List)          \
  X(Logger) X(Manager) X(Map) X(Mask) X(Material) X(Matrix) X(Memory) X(Mesh) X(Message) X(Method) X(Metric) X(Mode)  \
  X(Model) X(Name) X(Need) X(Node) X(Number) X(Object) X(Option) X(Options) X(Order) X(Output) X(Pair) X(Panel)       \
  X(Param) X(Parameter) X(Params) X(Part) X(Particle) X(Path) X(Phase) X(Pixel) X(Plane) X(Player) X(Point) X(Pool)   \
  X(Position) X(Process) X(Program) X(Property) X(Query) X(Queue) X(Random) X(Range) X(Rect) X(Region) X(Renderer)    \
  X(Request) X(Resource) X(Result) X(Role) X(Rotation) X(Row) X(Sample) X(Scene) X(Score) X(Series) X(Session)        \
  X(Set) X(Settings) X(Size) X(Slot) X(Slots) X(Sprite) X(State) X(Status) X(Step) X(Store) X(Stream) X(String)       \
  X(Style) X(System) X(Table) X(Tag) X(Task) X(Text) X(Texture) X(Thread) X(Tick) X(Tile) X(Time) X(Timer) X(Token)   \
  X(Transform) X(Tree) X(Trial) X(Type) X(Unit) X(Update) X(User) X(Value) X(Vector) X(Velocity) X(Version)           \
  X(Vertex) X(View) X(Visitor) X(Weight) X(Window) X(Work) X(Worker)
// clang-format on
#define DECLARE_TYPE(name) \
  struct name {            \
    int mine = 1;          \
  };
EVERYDAY_TYPES(DECLARE_TYPE)

namespace {

double mix(double a, double b) { return (a + b) / 2; }
double clamp(double x) { return x < 0 ? 0 : x; }
double length(const double (&v)[2]) { return v[0] + v[1]; }
int count(int n) { return n; }
int plural(int n) { return n != 1; }
int times(int n) { return n; }
int step(int n) { return n + 1; }
double lerp(double a, double b, double t) { return a + t * (b - a); }
double radians(double degrees) { return degrees / 57; }

using namespace lpc;

TEST(EverydayNames, MeanTheUsersOwn) {
  int mine = 0;
#define USE_TYPE(name) mine += name{}.mine;
  EVERYDAY_TYPES(USE_TYPE)
  EXPECT_GT(mine, 150);
  EXPECT_EQ(mix(0, 2) + clamp(-1) + length({1, 2}) + lerp(0, 1, 1) + radians(57), 6);
  EXPECT_EQ(count(1) + plural(2) + times(3) + step(4), 10);
  World<2> world;  // ours, unqualified
  BodyDef<2> ball;
  ball.shapes.push_back({.shape = Shape<2>::sphere(1)});
  world.add(ball);
  world.step(Real(1) / 60);
  EXPECT_EQ(world.profiler().frame().work[WorkCount::pairQueries], 0u);
}

}  // namespace
