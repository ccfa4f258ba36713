// Menus by the right button of the pointer, or the menu key.
import { useEffect, useLayoutEffect, useRef, useState } from "react";
import { create } from "zustand";

export interface MenuItem {
  name: string;
  /** The keys that do the same. */
  keys?: string | undefined;
  off?: boolean | undefined;
  take(): void;
}

/** A null parts what is above from what is below. */
export type MenuItems = (MenuItem | null)[];

/** Without what is left out, and without lines that part nothing. */
export const menuOf = (...items: (MenuItem | null | false)[]): MenuItems =>
  items.filter((i): i is MenuItem | null => i !== false)
    .filter((i, at, all) => i !== null || (all.slice(0, at).some(Boolean) && all[at + 1] !== null && at < all.length - 1));

const useMenu = create<{ menu: { x: number; y: number; label: string; items: MenuItems } | null }>(() => ({ menu: null }));

/** Opens a menu at a place of the page. */
export const showMenu = (at: { clientX: number; clientY: number }, label: string, items: MenuItems): void =>
  useMenu.setState({ menu: { x: at.clientX, y: at.clientY, label, items } });

const kMargin = 4;

export function Menu() {
  const menu = useMenu((s) => s.menu);
  const [index, setIndex] = useState(-1);
  const list = useRef<HTMLUListElement>(null);
  const before = useRef<HTMLElement | null>(null);
  const close = (back = true) => {
    useMenu.setState({ menu: null });
    if (back) before.current?.focus({ preventScroll: true });
  };
  useLayoutEffect(() => {
    const box = list.current;
    if (!menu || !box) return;
    box.style.left = `${Math.max(kMargin, Math.min(menu.x, innerWidth - box.offsetWidth - kMargin))}px`;
    box.style.top = `${Math.max(kMargin, Math.min(menu.y, innerHeight - box.offsetHeight - kMargin))}px`;
    before.current = document.activeElement as HTMLElement | null;
    setIndex(-1);
    box.focus();
  }, [menu]);
  useEffect(() => {
    if (!menu) return;
    const leave = (e: Event) => !list.current?.contains(e.target as Node) && close(false);
    for (const type of ["pointerdown", "wheel", "resize"]) addEventListener(type, leave, true);
    return () => ["pointerdown", "wheel", "resize"].forEach((type) => removeEventListener(type, leave, true));
  }, [menu]);
  if (!menu) return null;
  const { items } = menu;
  const can = (i: number) => items[i] && !items[i]!.off;
  const move = (by: 1 | -1) => {
    for (let i = index < 0 && by < 0 ? items.length - 1 : index + by, n = 0; n < items.length; i += by, ++n)
      if (can((i + items.length) % items.length)) return setIndex((i + items.length) % items.length);
  };
  const take = (item: MenuItem | null | undefined) => {
    if (!item || item.off) return;
    // First the keyboard goes back, so that it may be taken on.
    close();
    item.take();
  };
  const key = (e: React.KeyboardEvent) => {
    if (e.key === "ArrowDown") move(1);
    else if (e.key === "ArrowUp") move(-1);
    else if (e.key === "Enter" || e.key === " ") take(items[index]);
    else if (e.key === "Escape" || e.key === "Tab") close();
    e.preventDefault();
    e.stopPropagation();
  };
  return (
    <ul
      ref={list} className="menu" role="menu" aria-label={menu.label} tabIndex={-1} onKeyDown={key} onContextMenu={(e) => e.preventDefault()}
      aria-activedescendant={index < 0 ? undefined : `menu-${index}`}
    >
      {items.map((item, i) => item ? (
        <li
          key={item.name} id={`menu-${i}`} role="menuitem" aria-disabled={item.off} aria-keyshortcuts={item.keys} className={i === index ? "at" : ""}
          onPointerMove={() => setIndex(can(i) ? i : -1)} onClick={() => take(item)}
        >
          <span>{item.name}</span>{item.keys && <kbd aria-hidden>{item.keys}</kbd>}
        </li>
      ) : <li key={i} role="separator" />)}
    </ul>
  );
}

/** Copies a text for other programs, too. */
export async function copyText(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // A page that did not come over https, or from this machine, may not; the older way is left to it.
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}
