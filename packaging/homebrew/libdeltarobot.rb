# Untried: nobody has run Homebrew on it; the tests check its syntax alone. It builds the clone that it lies in:
# brew install --HEAD --formula libdeltarobot/packaging/homebrew/libdeltarobot.rb
class Libdeltarobot < Formula
  desc "Deltarobot serial protocol, Ozeki line protocol and GX binary vectors"
  license any_of: ["MIT", "Apache-2.0"]
  head "file://#{File.expand_path("../..", __dir__)}", using: :git

  depends_on "make" => :build
  depends_on "rust" => :build

  def install
    system "gmake", "install", "install-cli", "PREFIX=#{prefix}"
  end

  test do
    assert_match "STATUS?", shell_output("#{bin}/deltarobot decode 24 53 00 B1 3A")
    (testpath/"main.c").write <<~C
      #include <libdeltarobot/protocol_ext.h>
      #include <string.h>
      int main(void) { return strcmp(dp_version(), DP_VERSION_STRING); }
    C
    system ENV.cc, "main.c", "-I#{include}", "#{lib}/libdeltarobot.a", "-o", "main"
    system "./main"
  end
end
