import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

// The server's content security policy allows scripts of its own only, so nothing is inlined.
export default defineConfig({
  plugins: [react()],
  // By its number, as `localhost` needs a name service or a hosts file.
  server: { host: "127.0.0.1" },
  test: { css: true },
  build: { assetsInlineLimit: 0, chunkSizeWarningLimit: 1500 },
});
